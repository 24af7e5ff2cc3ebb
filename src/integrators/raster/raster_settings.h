#pragma once

// What a rasterised picture is asked for, beside scene and camera.

#include <cstdint>

#include "math/rgb.h"

namespace pertev {

/// Where light is evaluated: once a triangle, at its corners and interpolated (Gouraud 1971), or in every pixel with
/// interpolated normals (Phong 1975).
enum class RasterShading : uint8_t { Flat, Gouraud, Phong };

struct RasterLook {
    RasterShading shading = RasterShading::Phong;
    bool is_wireframe = false; // edges of triangles alone
    bool operator==(const RasterLook&) const = default;
};

struct RasterSettings {
    RasterLook look;
    uint32_t max_depth = 16; // 0: what emits alone; else direct light too
    uint32_t seed = 0;
    bool has_ambient = false; // it was asked for; else it is the mean of the environment
    Rgb ambient = {0, 0, 0};  // radiance from all around that diffuse surfaces reflect, W/(sr m2)
    bool operator==(const RasterSettings&) const = default;
};

} // namespace pertev
