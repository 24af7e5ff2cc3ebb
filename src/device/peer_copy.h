#pragma once

// Copies from one device's memory to another's, by the shortest path that the machine has.

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "device/queue.h"

namespace pertev {

enum class CopyPath : uint8_t {
    Memory, // within the memory of one device
    NvLink, // directly
    Pcie,   // directly
    Host,   // through the memory of the host
};

CopyPath copy_path(const Queue& from, const Queue& to);
/// Returns its name for people.
std::string_view name_of_path(CopyPath path);

/// Lets `to` read the memory of `from` directly where the machine can. It may take a while, and without it the first
/// copy takes another path.
void allow_copies(Queue& to, const Queue& from);

/// Copies `bytes` from memory of one queue's device to that of another's, and returns when that is done. All work of
/// `from` on these bytes must be done. Throws Error(DeviceFault, OutOfMemory).
void copy_between(Queue& to, void* into, Queue& from, const void* source, std::size_t bytes);
/// Copies as copy_between(), but may return before the copy is done: work that is queued on `to` afterwards sees the
/// bytes.
void start_copy_between(Queue& to, void* into, Queue& from, const void* source, std::size_t bytes);

#if defined(PERTEV_HAS_CUDA)

// The part of two CUDA devices.
CopyPath cuda_copy_path(int from, int to);
void allow_copies_between_gpus(Queue& to, int from);
void copy_between_gpus(Queue& to, void* into, int from, const void* source, std::size_t bytes);

#endif

} // namespace pertev
