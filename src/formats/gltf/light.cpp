#include "formats/gltf/light.h"

#include <fmt/format.h>

#include "math/portable_math.h"

namespace pertev::gltf {

Light read_light(const JsonValue& source) {
    Light light;
    light.name = source.string_or("name", "");
    const std::string type = source.string_or("type", "");
    if (type == "point")
        light.kind = LightKind::Point;
    else if (type == "spot")
        light.kind = LightKind::Spot;
    else if (type == "directional")
        light.kind = LightKind::Directional;
    else
        throw source.error(fmt::format("type \"{}\"; expected point, spot or directional", type));

    const std::array<float, 3> color = source.floats_or<3>("color", {1, 1, 1});
    light.intensity = source.float_or("intensity", 1) * Rgb{color[0], color[1], color[2]};
    light.range = source.float_or("range", 0);
    if (light.range < 0) throw source.at("range").error("expected a number above 0");
    if (light.kind != LightKind::Spot) return light;

    float inner = 0, outer = kPi / 4;
    if (const std::optional<JsonValue> spot = source.find("spot")) {
        inner = spot->float_or("innerConeAngle", inner);
        outer = spot->float_or("outerConeAngle", outer);
        if (!(inner >= 0 && inner < outer && outer <= kPi / 2)) {
            throw spot->error(
                fmt::format("cone angles {} and {}; expected 0 <= inner < outer <= pi / 2", inner, outer));
        }
    }
    light.cos_inner = cos(inner);
    light.cos_outer = cos(outer);
    return light;
}

bool place_light(const Transform& world_from_node, Light& light) {
    light.position = world_from_node.translation;
    light.direction = normalize(-column(world_from_node, 2));
    return light.kind == LightKind::Point || is_finite(light.direction);
}

} // namespace pertev::gltf
