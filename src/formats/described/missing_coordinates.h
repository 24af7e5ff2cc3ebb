#pragma once

// Coordinates of triangles whose file states none: each format gives every triangle the same ones.

#include "formats/described/parts.h"

namespace pertev::described {

/// Returns whether textures of the shape use coordinates that its mesh does not have.
bool lacks_coordinates(const Parts& parts, const Placed& shape, const ShapeMesh& mesh);

/// Gives a mesh that lacks its own coordinates those of the file's kind (`Parts::missing_coordinates`), if the
/// shape lacks them.
void give_missing_coordinates(const Parts& parts, const Placed& shape, ShapeMesh& mesh);

} // namespace pertev::described
