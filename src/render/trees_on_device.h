#pragma once

// The trees of a prepared scene in a device's memory.

#include <cstddef>

#include "device/buffer.h"
#include "render/prepare_scene.h"
#include "trace/scene_bvh.h"

namespace pertev {

/// Copies them into `buffer` (see PartArrays::upload); the CPU gets the 8-wide nodes of its vector walk beside.
SceneBvhView upload_trees(Queue& queue, const PreparedScene& prepared, Buffer<std::byte>& buffer);

/// Bytes of that buffer, the CPU's wide nodes left out: they are only known once they are made.
std::size_t predicted_tree_bytes(const PreparedScene& prepared);

} // namespace pertev
