#pragma once

// Vertex colours of formats that do not define them, OBJ and PLY. They are display values, sRGB, as integers or
// fractions. Scanners and photogrammetry copy them from photographs and at most divide by 255, and Blender writes and
// reads both formats so. glTF defines its colours as linear.

#include <string>
#include <vector>

#include "base/sink.h"
#include "math/vec4.h"

namespace pertev {

/// A vertex without a colour among others that have one. It becomes white.
inline constexpr Vec4 kNoVertexColor = {1, 1, 1, -1};

/// Converts fractional colours of a file to linear ones. They are display values in [0, 1], or, with a notice, in [0,
/// 255] if any is 2 or more: smaller excesses may be rounding or highlights, which validate() clamps. Alpha, which is
/// linear, is treated separately.
void decode_vertex_colors(std::vector<Vec4>& colors, const std::string& file, Sink& sink);

} // namespace pertev
