#pragma once

// Lights that are not surfaces: the three kinds of KHR_lights_punctual, and the environment.

#include <cstdint>
#include <string>

#include "image/image.h"
#include "math/rgb.h"
#include "math/transform.h"
#include "scene/node_number.h"

namespace pertev {

enum class LightKind : uint8_t { Point, Spot, Directional };

struct Light {
    std::string name, origin;
    LightKind kind = LightKind::Point;
    Vec3 position;               // Point, Spot: metres, world space
    Vec3 direction = {0, -1, 0}; // Spot, Directional: unit, direction in which the light travels, world space
    Rgb intensity = {1, 1, 1};   // Point, Spot: W/sr; Directional: irradiance on a surface that faces it, W/m2
    float cos_inner = 1;         // Spot: full intensity inside, falling to 0 at cos_outer (< cos_inner)
    float cos_outer = 0.70710678f;
    float range = 0;         // Point, Spot: metres beyond which it gives no light; 0: unlimited
    uint32_t node = kNoNode; // index into Scene::nodes
};

/// Properties that a kind of light has besides its strength.
struct LightParts {
    bool position, direction, cone;
};
constexpr LightParts parts_of(LightKind kind) {
    switch (kind) {
    case LightKind::Point:
        return {.position = true, .direction = false, .cone = false};
    case LightKind::Spot:
        return {.position = true, .direction = true, .cone = true};
    case LightKind::Directional:
        break;
    }
    return {.position = false, .direction = true, .cone = false};
}

/// The smallest difference between floats just below 1; the edge of a cone with two equal angles has this width.
inline constexpr float kSharpestEdge = 0x1p-24f;

/// Places `light` at the origin of a node, shining along the node's -z; scaling does not affect its strength. Returns
/// false if the direction is lost.
inline bool transform_light(const Transform& world_from_node, Light& light) {
    light.position = world_from_node.translation;
    light.direction = normalize(-column(world_from_node, 2));
    return !parts_of(light.kind).direction || is_finite(light.direction);
}

/// Light from infinitely far away. Image columns follow longitude: the middle column looks along -z, +x is a quarter
/// to the right of it; row 0 is +y.
struct Environment {
    Image image;           // 3 channels, equirectangular, W/(sr m2); empty: uniform `scale`
    Rgb scale = {1, 1, 1}; // factor for the image
    float rotation = 0;    // radians around +y, counter-clockwise seen from above
};

} // namespace pertev
