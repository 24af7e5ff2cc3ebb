#pragma once

// A mesh whose vertices were moved on the device: what its tree there is fitted to.

#include <cstdint>

#include "math/vec3.h"

namespace pertev {

/// Plain pointers, the device's.
struct DeformedMesh {
    uint32_t mesh = 0;       // index into Scene::meshes
    uint32_t tree = 0;       // number of its own tree (MeshPlacement::tree_of_mesh)
    uint64_t version = 0;    // another one each time the vertices have moved; never 0
    uint32_t triangles = 0;  // the same ones always
    const Vec3* positions;   // [vertices], local space, metres
    const uint32_t* indices; // [3 * triangles]
};

} // namespace pertev
