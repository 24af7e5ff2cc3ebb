#pragma once

// The positions of an OBJ file in double, for files whose things lie far from the origin: read once more, so that other
// files are read no slower.

#include <span>
#include <string_view>

#include "math/double_vec3.h"

namespace pertev {

/// Reads the positions of a piece of a text that holds whole statements: as many as `positions` takes, which it has.
/// A number that cannot be read is NaN. `end_of_line`: ObjLines::end_of_line_of the whole text.
void read_obj_positions(std::string_view piece, char end_of_line, std::span<DoubleVec3> positions);

} // namespace pertev
