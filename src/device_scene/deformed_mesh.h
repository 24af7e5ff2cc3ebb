#pragma once

// A mesh whose vertices have moved on the device, with the data to refit its tree.

#include <cstdint>

#include "math/vec3.h"

namespace pertev {

/// A mesh whose vertices move, as plain device pointers.
struct DeformedMesh {
    uint32_t mesh = 0;       // index into Scene::meshes
    uint32_t tree = 0;       // index of its BLAS (MeshPlacement::blas_of_mesh)
    uint64_t version = 0;    // changes each time the vertices have moved; never 0
    uint32_t triangles = 0;  // number of triangles, which is constant
    const Vec3* positions;   // [vertices], local space, metres
    const uint32_t* indices; // [3 * triangles]
};

} // namespace pertev
