#pragma once

// Bilinear patches as triangles. Flat patches become two triangles each; if a patch of the mesh is curved, all are cut
// into equal squares of parameters, so many that no point is further from the surface than a thousandth of the curved
// patch's diagonal (at most 32 x 32, and no more than 2^20 triangles of a mesh that has fewer patches).

#include <array>
#include <cstdint>
#include <vector>

#include "scene/mesh.h"

namespace pertev {

/// The corners of a patch at (u, v) = (0, 0), (1, 0), (0, 1) and (1, 1); its front is where du x dv points.
using BilinearCorners = std::array<uint32_t, 4>;

/// Replaces `patches`, whose corners are vertices of `mesh`, all in range, by its triangles. Without normals curved
/// patches get their own. Without texture coordinates those of each patch are (u, 1 - v).
void triangulate_patches(const std::vector<BilinearCorners>& patches, Mesh& mesh);

} // namespace pertev
