#pragma once

// Settings of a rasterized picture besides scene and camera.

#include <cstdint>

#include "base/value_names.h"
#include "math/rgb.h"

namespace pertev {

/// Points at which light is evaluated: once per triangle, at its corners with interpolation (Gouraud 1971), or in every
/// pixel with interpolated normals (Phong 1975).
enum class RasterShading : uint8_t { Flat, Gouraud, Phong };

inline constexpr ValueName<RasterShading> kRasterShadings[] = {
    {RasterShading::Flat, "flat"}, {RasterShading::Gouraud, "gouraud"}, {RasterShading::Phong, "phong"}};
constexpr const auto& names_of_all(RasterShading) { return kRasterShadings; }

struct RasterDisplay {
    RasterShading shading = RasterShading::Phong;
    bool is_wireframe = false; // draws only the edges of triangles
    bool operator==(const RasterDisplay&) const = default;
};

struct RasterSettings {
    RasterDisplay display;
    uint32_t max_depth = 16; // 0: emission only; otherwise direct light too
    uint32_t seed = 0;
    bool has_ambient = false; // `ambient` was given; otherwise it is the mean of the environment
    Rgb ambient = {0, 0, 0};  // radiance from all directions that diffuse surfaces reflect, W/(sr m2)
    bool operator==(const RasterSettings&) const = default;
};

} // namespace pertev
