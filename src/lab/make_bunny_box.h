#pragma once

// The scene "bunny" of the record (docs/ray_sets.md): a scanned mesh, made sixteen times finer and a little rough, in a
// box without front and ceiling. The same bits on every machine.

#include "scene/mesh.h"

namespace pertev {

/// Every triangle cut into four, twice, then scaled to a height of 2, centred in x and z and stood on y = 0, in a box
/// with x and z in [-3, 3] and y in [0, 4]: a floor and three walls of 32 x 32 quads each. Positions and indices alone.
/// The mesh has a height.
///
/// A new vertex lies at the middle of its edge, moved along the mean of the two ends' normals by the bulge of a smooth
/// surface there and by up to 5 % of the edge's length.
Mesh make_bunny_box(const Mesh& bunny);

} // namespace pertev
