#pragma once

// What build_point_octree takes of the host's memory.

#include <cstddef>
#include <cstdint>

#include "accel/octree/point_octree.h"

namespace pertev {

/// Bytes for so many spheres at most: the tree, and while it is built two lists of numbers.
inline std::size_t most_octree_bytes(uint64_t spheres) {
    return spheres * (2 * sizeof(PointOctreeNode) + sizeof(Sphere) + 3 * sizeof(uint32_t));
}

} // namespace pertev
