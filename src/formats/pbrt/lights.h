#pragma once

// Lights of pbrt. Strengths follow colors.h. A spot's edge falls off as that of KHR_lights_punctual, which is darker
// than pbrt's.

#include <optional>
#include <string>

#include "formats/pbrt/context.h"
#include "formats/pbrt/parameters.h"
#include "formats/pbrt/textures.h"
#include "math/double_transform.h"
#include "scene/light.h"

namespace pertev::pbrt {

/// The emission of shapes (AreaLightSource).
struct AreaLight {
    Rgb radiance;       // W/(sr m2), times the image
    TextureValue image; // if it has one
    bool is_two_sided = false;
    double power = 0; // above 0: of each triangle or other shape; `radiance` is then its colour
};

/// A light at infinity around the scene.
struct InfiniteLight {
    FileLocation location;
    Rgb scale;               // W/(sr m2), times the picture
    std::string picture;     // name of a file; empty: uniform
    bool is_latlong = false; // pbrt-v3's picture; else the equal-area octahedron of v4
    double illuminance = 0;  // above 0: on a surface that faces +z of the light
    DoubleTransform world_from_light;
};

/// Returns nothing, with a warning, for a type that is left out.
std::optional<AreaLight> read_area_light(const std::string& type, Parameters& parameters, Textures& textures,
                                         const Context& context);
std::optional<InfiniteLight> read_infinite_light(Parameters& parameters, const DoubleTransform& world_from_light,
                                                 const Context& context);
/// Reads a point, spot or distant light.
std::optional<Light> read_light(const std::string& type, Parameters& parameters,
                                const DoubleTransform& world_from_light, const Context& context);

} // namespace pertev::pbrt
