#pragma once

// The coordinate system of OBJ and PLY files, which state neither their up axis nor their unit. The default is metres
// with y up, as in glTF. CAD programs write millimetres with z up.

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

/// Parses "x", "y" or "z"; nothing for other text.
std::optional<UpAxis> parse_up_axis(std::string_view text);

/// Names that parse_unit accepts, for messages.
inline constexpr const char* kUnitNames = "m, cm, mm, km, in, ft";
/// Metres of a unit, given by name or as a number above 0; nothing for other text.
std::optional<double> parse_unit(std::string_view text);

/// Converts a scene from `space` to metres with y up: z up becomes (x, z, -y), x up (-y, x, z). The scene has only
/// instances, no cameras, lights or nodes.
void convert_to_metres(const FileSpace& space, Scene& scene);

} // namespace pertev
