#pragma once

// Refuses a render that does not fit into memory before it begins, so that the system does not end it while its film
// fills.

#include <cstddef>
#include <optional>

#include "device/queue.h"
#include "settings/render_settings.h"

namespace pertev {

/// Memory that a render may take on a device.
struct MemoryLimit {
    std::size_t bytes;
    bool is_requested; // set by `max_memory`; otherwise the machine's free memory less the finished picture
    bool is_cuda;      // the GPU's own memory, otherwise the machine's
};

/// Memory of the queue's device: `requested`, or by default on the CPU the machine's free memory less the finished
/// picture and its layers, and on a GPU everything that it can allocate.
MemoryLimit memory_to_render_in(const Queue& queue, const RenderSettings& settings,
                                std::optional<std::size_t> requested);

/// Throws Error(OutOfMemory) if a render needs more: `bytes`, the result of predicted_bytes. The message names the
/// limit and the settings that need less. `textures` are the bytes of the scene's textures.
void check_render_memory(std::size_t bytes, const RenderSettings& settings, const MemoryLimit& limit,
                         uint64_t textures = 0);

} // namespace pertev
