#pragma once

// A mapping gives a surface texture coordinates by where it is. Its v points up, as in pbrt.
//
// Source: Pharr, Jakob, Humphreys, "Physically Based Rendering", 4th ed., section 10.2.

#include "math/double_transform.h"

namespace pertev::described {

enum class MappingKind {
    Planar,
    Spherical,   // by the angle from +z and the angle around it
    Cylindrical, // by the angle around +z and the height on a sphere
};

/// The axes and offsets are those of a plane.
struct TextureMapping {
    MappingKind kind = MappingKind::Planar;
    DoubleTransform texture_from_world; // from the file's world
    DoubleVec3 u_axis = {1, 0, 0}, v_axis = {0, 1, 0};
    double u_offset = 0, v_offset = 0;
    bool operator==(const TextureMapping&) const = default;
};

} // namespace pertev::described
