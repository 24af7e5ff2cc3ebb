#pragma once

// The scene "forest" of the record (docs/ray_sets.md): a hilly ground with trees of loose leaves, 8.2 million triangles
// that are small, far apart and turned every way, the opposite of a room with walls. The same bits on every machine and
// for any number of threads.

#include "scene/mesh.h"

namespace pertev {

struct ForestSettings {
    uint32_t ground_quads = 700; // along each side of a ground of 200 x 200 metres
    uint32_t trees = 1200;
    uint32_t leaves = 3000; // quads of a tree

    uint32_t triangle_count() const;
};

/// Positions and indices alone; ground first, then tree after tree, each its trunk and its leaves.
Mesh make_forest(const ForestSettings& settings = {});

} // namespace pertev
