#include "formats/gltf/light.h"

#include <fmt/format.h>

#include "math/portable_math.h"

namespace pertev::gltf {
namespace {

void set_cone(float inner, float outer, Light& light) {
    light.cos_inner = cos(inner);
    light.cos_outer = min(cos(outer), light.cos_inner - kSharpestEdge);
}

void read_cone(const JsonValue& spot, Light& light, Messages& messages) {
    const float inner = spot.float_or("innerConeAngle", 0), outer = spot.float_or("outerConeAngle", kPi / 4);
    if (!(inner >= 0 && inner <= outer && outer > 0 && outer <= kPi / 2)) {
        throw spot.error(fmt::format("cone angles {} and {}; expected 0 <= inner < outer <= pi / 2", inner, outer));
    }
    if (inner == outer) {
        messages.warn(
            fmt::format("{}: inner and outer cone angle are both {}; expected inner < outer, the edge is sharp",
                        spot.place(), inner));
    }
    set_cone(inner, outer, light);
}

// What a light's strength is made of.
void check_not_negative(const JsonValue& number) {
    if (number.to_float() < 0)
        throw number.error(fmt::format("{}; expected a number of at least 0", number.to_float()));
}

} // namespace

Light read_light(const JsonValue& source, Messages& messages) {
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

    if (const std::optional<JsonValue> intensity = source.find("intensity")) check_not_negative(*intensity);
    for (const JsonValue& channel : source.elements_of("color")) check_not_negative(channel);
    const std::array<float, 3> color = source.floats_or<3>("color", {1, 1, 1});
    light.intensity = source.float_or("intensity", 1) * Rgb{color[0], color[1], color[2]};
    light.range = source.float_or("range", 0);
    if (light.range < 0) throw source.at("range").error("expected a number above 0");
    if (light.kind != LightKind::Spot) return light;

    if (const std::optional<JsonValue> spot = source.find("spot")) {
        read_cone(*spot, light, messages);
    } else {
        set_cone(0, kPi / 4, light);
    }
    return light;
}

} // namespace pertev::gltf
