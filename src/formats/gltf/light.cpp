#include "formats/gltf/light.h"

#include <limits>

#include <fmt/format.h>

#include "math/portable_math.h"

namespace pertev::gltf {
namespace {

constexpr float kNarrowestCone = 0x1p-10f; // radians

void set_cone(float inner, float outer, Light& light) {
    light.cos_inner = cos(inner);
    light.cos_outer = min(cos(outer), light.cos_inner - kSharpestEdge);
}

/// Angles out of range are brought into it: the lamp is there with the cone that comes nearest.
void read_cone(const JsonValue& spot, Light& light, Messages& messages) {
    constexpr float widest = kPi / 2;
    const float asked_inner = spot.float_or("innerConeAngle", 0),
                asked_outer = spot.float_or("outerConeAngle", kPi / 4);
    const float outer = asked_outer > 0 ? min(asked_outer, widest) : kNarrowestCone;
    const float inner = clamp(asked_inner, 0.0f, outer);
    if (asked_inner == asked_outer && inner == asked_inner && outer == asked_outer) {
        messages.warn(
            {spot.place(),
             fmt::format("inner and outer cone angle are both {}; expected inner < outer, the edge is sharp", inner)});
    } else if (inner != asked_inner || outer != asked_outer) {
        messages.warn({spot.place(),
                       fmt::format("cone angles {} and {}; expected 0 <= inner < outer <= pi / 2, {} and {} are taken",
                                   asked_inner, asked_outer, inner, outer)});
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
    constexpr float largest = std::numeric_limits<float>::max();
    const float intensity = source.float_or("intensity", 1);
    light.intensity = {min(intensity * color[0], largest), min(intensity * color[1], largest),
                       min(intensity * color[2], largest)};
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
