#pragma once

// Vertex colours of formats that do not say what their numbers mean: OBJ and PLY. They are display values, sRGB,
// whether they are whole numbers or not. Scanners and photogrammetry take them from photographs and divide by 255 at
// most, and Blender writes and reads both formats so. glTF says that its own are linear.

#include <string>
#include <vector>

#include "base/messages.h"
#include "math/vec4.h"

namespace pertev {

/// Stands for a vertex without a colour among others that have one. It becomes white.
inline constexpr Vec4 kNoVertexColor = {1, 1, 1, -1};

/// Makes colours as a file writes them in numbers with fractions linear. They are display values in [0, 1], or, with a
/// notice, in [0, 255] where one of all is 2 or more: less than that may be rounding or a highlight, and is left for
/// validate() to clamp. Alpha, which is linear, is judged by itself.
void decode_vertex_colors(std::vector<Vec4>& colors, const std::string& file, Messages& messages);

} // namespace pertev
