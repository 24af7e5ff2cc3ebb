#pragma once

// What coordinates of OBJ and PLY files mean: these formats say neither which way is up nor how long a unit is. Ours
// are metres with y up, as those of glTF. CAD programs write millimetres with z up.

#include <optional>
#include <string_view>

#include "scene/scene.h"

namespace pertev {

enum class UpAxis { X, Y, Z };

struct FileSpace {
    UpAxis up_axis = UpAxis::Y;
    double unit_m = 1; // metres
    bool operator==(const FileSpace&) const = default;
};

/// "x", "y" or "z"; nothing for other text.
std::optional<UpAxis> parse_up_axis(std::string_view text);

/// The names that parse_unit knows, for messages.
inline constexpr const char* kUnitNames = "m, cm, mm, km, in, ft";
/// The metres of a unit by its name, or as a number above 0; nothing for other text.
std::optional<double> parse_unit(std::string_view text);

/// Turns and scales all of a scene from `space` to metres with y up: z up becomes (x, z, -y), x up (-y, x, z). The
/// scene has instances alone, no cameras, lights or nodes.
void place_in_metres(const FileSpace& space, Scene& scene);

} // namespace pertev
