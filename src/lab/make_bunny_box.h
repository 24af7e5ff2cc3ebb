#pragma once

// The scene "bunny" of the record (docs/ray_sets.md): a scanned mesh, refined sixteenfold and slightly roughened, in
// a box without front and ceiling. Its bits are equal on every machine.

#include "scene/mesh.h"

namespace pertev {

/// Splits every triangle into four, twice, then scales the mesh to a height of 2, centres it in x and z and places
/// it on y = 0. The box spans [-3, 3] in x and z and [0, 4] in y: a floor and three walls of 32 x 32 quads each. Only
/// positions and indices are filled. The given mesh must have a height.
///
/// A new vertex lies at the middle of its edge, moved along the mean of both ends' normals by the bulge of a smooth
/// surface there and by up to 5 % of the edge's length.
Mesh make_bunny_box(const Mesh& bunny);

} // namespace pertev
