#pragma once

// A render that does not fit is refused before it begins, rather than ended by the system when its film fills.

#include <cstddef>
#include <optional>

#include "device/queue.h"
#include "settings/render_settings.h"

namespace pertev {

/// What a render may take of a device.
struct MemoryLimit {
    std::size_t bytes;
    bool is_asked; // by `max_memory`; else it is what the machine has beside the finished picture
    bool is_cuda;  // the device's own memory; else the machine's
};

/// Of the queue's device: `asked`, or without it, on the CPU, what the machine has but for the finished picture and its
/// layers, and on a GPU whatever it gives when it is asked.
MemoryLimit memory_to_render_in(const Queue& queue, const RenderSettings& settings, std::optional<std::size_t> asked);

/// Throws Error(OutOfMemory) where a render takes more: `bytes`, as predicted_bytes says. It says which limit that is,
/// and which settings would take less.
void check_render_memory(std::size_t bytes, const RenderSettings& settings, const MemoryLimit& limit);

} // namespace pertev
