#pragma once

// Lights that are not surfaces: KHR_lights_punctual's three kinds, and the environment.

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
    Vec3 direction = {0, -1, 0}; // Spot, Directional: unit, the way the light travels, world space
    Rgb intensity = {1, 1, 1};   // Point, Spot: W/sr; Directional: irradiance on a surface that faces it, W/m2
    float cos_inner = 1;         // Spot: full intensity within, falling to 0 at cos_outer (< cos_inner)
    float cos_outer = 0.70710678f;
    float range = 0;         // Point, Spot: metres past which it gives no light; 0 = no end
    uint32_t node = kNoNode; // index into Scene::nodes
};

/// Beside 1, the smallest difference of two floats: cones of one angle have this sharp an edge.
inline constexpr float kSharpestEdge = 0x1p-24f;

/// Puts `light` at the origin of a node, shining along the node's -z; its strength does not scale. False where that
/// direction is lost.
inline bool place_light(const Transform& world_from_node, Light& light) {
    light.position = world_from_node.translation;
    light.direction = normalize(-column(world_from_node, 2));
    return light.kind == LightKind::Point || is_finite(light.direction);
}

/// Light from infinitely far away. Image columns run with longitude: the middle column looks along -z, +x is a quarter
/// to the right of it; row 0 is +y.
struct Environment {
    Image image;           // 3 channels, equirectangular, W/(sr m2); empty: `scale` alone, from everywhere
    Rgb scale = {1, 1, 1}; // times the image
    float rotation = 0;    // radians about +y, counter-clockwise seen from above
};

} // namespace pertev
