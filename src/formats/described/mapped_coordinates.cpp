#include "formats/described/mapped_coordinates.h"

#include <algorithm>
#include <cmath>

#include "math/portable_math.h"

namespace pertev::described {
namespace {

/// Returns the angle of a vector over a whole turn, from -1/2 to 1/2.
double share_of_turn(double y, double x) {
    return static_cast<double>(atan2(static_cast<float>(y), static_cast<float>(x))) / (2 * kPiDouble);
}

} // namespace

double Coordinates::*around_of(MappingKind kind) {
    return kind == MappingKind::Spherical ? &Coordinates::t : &Coordinates::s;
}

Coordinates coordinates_at(const TextureMapping& by, DoubleVec3 world) {
    const DoubleVec3 at = transform_point(by.texture_from_world, world);
    if (by.kind == MappingKind::Planar) return {by.u_offset + dot(at, by.u_axis), by.v_offset + dot(at, by.v_axis)};
    // The largest component becomes 1, so that no square overflows.
    const double size = std::max({std::abs(at.x), std::abs(at.y), std::abs(at.z)});
    if (!(size > 0) || !std::isfinite(size)) return {0, 0, true};
    const DoubleVec3 p = {at.x / size, at.y / size, at.z / size};
    const double length = std::sqrt(dot(p, p)), aside = std::sqrt(p.x * p.x + p.y * p.y);
    const double turn = share_of_turn(p.y, p.x);
    const bool is_on_axis = !(aside > 1e-6 * length);
    if (by.kind == MappingKind::Cylindrical) return {0.5 + turn, p.z / length, is_on_axis};
    return {2 * share_of_turn(aside, p.z), turn < 0 ? turn + 1 : turn, is_on_axis};
}

} // namespace pertev::described
