#include "formats/files/file_space.h"

#include <utility>

#include "formats/files/parse_number.h"
#include "math/transform.h"

namespace pertev {
namespace {

constexpr std::pair<std::string_view, double> kUnits[] = {{"m", 1},     {"cm", 0.01},   {"mm", 0.001},
                                                          {"km", 1000}, {"in", 0.0254}, {"ft", 0.3048}};
constexpr double kMinUnit = 1e-12, kMaxUnit = 1e12;

/// Returns the transform from the file's coordinates to metres with y up.
Transform metres_from(const FileSpace& space) {
    const auto unit = static_cast<float>(space.unit_m);
    switch (space.up_axis) {
    case UpAxis::X:
        return {{0, -unit, 0}, {unit, 0, 0}, {0, 0, unit}, {}};
    case UpAxis::Y:
        break;
    case UpAxis::Z:
        return {{unit, 0, 0}, {0, 0, unit}, {0, -unit, 0}, {}};
    }
    return make_scale({unit, unit, unit});
}

DoubleVec3 in_metres(const FileSpace& space, DoubleVec3 p) {
    p = {space.unit_m * p.x, space.unit_m * p.y, space.unit_m * p.z};
    switch (space.up_axis) {
    case UpAxis::X:
        return {-p.y, p.x, p.z};
    case UpAxis::Y:
        break;
    case UpAxis::Z:
        return {p.x, p.z, -p.y};
    }
    return p;
}

} // namespace

std::optional<UpAxis> parse_up_axis(std::string_view text) {
    if (text == "x" || text == "X") return UpAxis::X;
    if (text == "y" || text == "Y") return UpAxis::Y;
    if (text == "z" || text == "Z") return UpAxis::Z;
    return std::nullopt;
}

std::optional<double> parse_unit(std::string_view text) {
    for (const auto& [name, metres] : kUnits) {
        if (text == name) return metres;
    }
    const std::optional<double> number = parse_whole_float<double>(text);
    if (!number || !(*number >= kMinUnit && *number <= kMaxUnit)) return std::nullopt;
    return number;
}

void convert_to_metres(const FileSpace& space, Scene& scene) {
    if (space == FileSpace()) return;
    const Transform metres = metres_from(space);
    scene.origin_in_file = in_metres(space, scene.origin_in_file);
    for (Instance& instance : scene.instances) instance.world_from_local = compose(metres, instance.world_from_local);
}

} // namespace pertev
