#pragma once

// The scene "forest" of the record (docs/ray_sets.md): hilly ground with trees of loose leaves. Its 8.2 million
// triangles are small, sparse and randomly oriented, unlike a room with walls. Its bits are equal on every machine
// and for any number of threads.

#include "scene/mesh.h"

namespace pertev {

struct ForestSettings {
    uint32_t ground_quads = 700; // along each side of the ground, which measures 200 x 200 metres
    uint32_t trees = 1200;
    uint32_t leaves = 3000; // quads per tree

    uint32_t triangle_count() const;
};

/// Makes positions and indices only: the ground first, then each tree with its trunk and leaves.
Mesh make_forest(const ForestSettings& settings = {});

} // namespace pertev
