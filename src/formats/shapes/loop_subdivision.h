#pragma once

// Loop subdivision surfaces as triangles: after some steps vertices are moved to the limit surface. The distance of the
// mesh from that surface falls by about 4 with each step.
//
// Source: Loop, "Smooth Subdivision Surfaces Based on Triangles", 1987, with Warren's weights; rules of boundaries and
// limits as in Hoppe et al., "Piecewise Smooth Surface Reconstruction", SIGGRAPH 1994. Normals are means of the
// adjacent triangles' by their angles.

#include <cstdint>

#include "scene/mesh.h"

namespace pertev {

/// The most triangles that a subdivided mesh may have, unless it has more before.
inline constexpr uint64_t kMostSubdivided = uint64_t(1) << 20;

/// Subdivides positions and triangles of `mesh`, whose indices are in range, `levels` times, or less often if it would
/// have more than kMostSubdivided triangles. Returns the number of steps. Texture coordinates, normals and colours of
/// the mesh are dropped; it gets normals.
uint32_t subdivide_loop(uint32_t levels, Mesh& mesh);

} // namespace pertev
