#pragma once

// Lights that are not surfaces: the three kinds of KHR_lights_punctual, lights whose intensity follows a table, and the
// environment.

#include <cstdint>
#include <memory>
#include <string>

#include "image/image.h"
#include "math/rgb.h"
#include "math/transform.h"
#include "scene/node_number.h"

namespace pertev {

struct IntensityTable;

enum class LightKind : uint8_t { Point, Spot, Directional, Goniometric };

struct Light {
    std::string name, origin;
    LightKind kind = LightKind::Point;
    Vec3 position;               // metres, world space; not of Directional
    Vec3 direction = {0, -1, 0}; // not of Point: unit, direction in which the light travels, world space
    Rgb intensity = {1, 1, 1};   // W/sr, of Goniometric where the table is 1; Directional: irradiance on a surface that
                                 // faces it, W/m2
    float cos_inner = 1;         // Spot: full intensity inside, falling to 0 at cos_outer (< cos_inner)
    float cos_outer = 0.70710678f;
    float range = 0;         // metres beyond which it gives no light; 0: unlimited; not of Directional
    uint32_t node = kNoNode; // index into Scene::nodes

    // Goniometric: the frame of its table (scene/intensity_table.h). `up` is unit and not along the direction.
    std::shared_ptr<const IntensityTable> table;
    Vec3 up = {0, 0, -1};
    bool is_mirrored = false;

    bool is_hidden = false; // its node is not visible: it gives no light
};

/// Returns what a light gives now, in the unit of its intensity.
inline Rgb shown_intensity(const Light& light) { return light.is_hidden ? Rgb{0, 0, 0} : light.intensity; }

/// Properties that a kind of light has besides its strength.
struct LightParts {
    bool position, direction, cone, table;
};
constexpr LightParts parts_of(LightKind kind) {
    switch (kind) {
    case LightKind::Point:
        return {.position = true, .direction = false, .cone = false, .table = false};
    case LightKind::Spot:
        return {.position = true, .direction = true, .cone = true, .table = false};
    case LightKind::Goniometric:
        return {.position = true, .direction = true, .cone = false, .table = true};
    case LightKind::Directional:
        break;
    }
    return {.position = false, .direction = true, .cone = false, .table = false};
}

/// The smallest difference between floats just below 1; the edge of a cone with two equal angles has this width.
inline constexpr float kSharpestEdge = 0x1p-24f;

/// Returns whether the light has the directions that its kind needs.
inline bool is_oriented(const Light& light) {
    const LightParts parts = parts_of(light.kind);
    if (!parts.direction) return true;
    return is_finite(light.direction) && (!parts.table || length_squared(cross(light.direction, light.up)) > 1e-8f);
}

/// Places `light` at the origin of a node, shining along the node's -z, with +y up; scaling does not affect its
/// strength. Returns false if a direction is lost.
inline bool transform_light(const Transform& world_from_node, Light& light) {
    light.position = world_from_node.translation;
    light.direction = normalize(-column(world_from_node, 2));
    light.up = normalize(column(world_from_node, 1));
    light.is_mirrored = determinant(world_from_node) < 0;
    return is_oriented(light);
}

/// Light from infinitely far away. Image columns follow longitude: the middle column looks along -z, +x is a quarter
/// to the right of it; row 0 is +y.
struct Environment {
    Image image;           // 3 channels, equirectangular, W/(sr m2); empty: uniform `scale`
    Rgb scale = {1, 1, 1}; // factor for the image
    float rotation = 0;    // radians around +y, counter-clockwise seen from above
};

} // namespace pertev
