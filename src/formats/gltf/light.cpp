#include "formats/gltf/light.h"

#include <limits>

#include <fmt/format.h>

#include "formats/gltf/leave_out.h"
#include "math/portable_math.h"

namespace pertev::gltf {
namespace {

constexpr float kNarrowestCone = 0x1p-10f; // radians

void set_cone(float inner, float outer, Light& light) {
    light.cos_inner = cos(inner);
    light.cos_outer = min(cos(outer), light.cos_inner - kSharpestEdge);
}

/// Reads the angles of a spot light. Those out of range are clamped, so that the light has the nearest valid cone.
void read_cone(const JsonValue& spot, Light& light, Sink& sink) {
    constexpr float widest = kPi / 2;
    const float requested_inner = spot.float_or("innerConeAngle", 0),
                requested_outer = spot.float_or("outerConeAngle", kPi / 4);
    const float outer = requested_outer > 0 ? min(requested_outer, widest) : kNarrowestCone;
    const float inner = clamp(requested_inner, 0.0f, outer);
    if (requested_inner == requested_outer && inner == requested_inner && outer == requested_outer) {
        sink.warn(
            {spot.location(),
             fmt::format("inner and outer cone angle are both {}; expected inner < outer; the cone gets a sharp edge",
                         inner)});
    } else if (inner != requested_inner || outer != requested_outer) {
        sink.warn({spot.location(),
                   fmt::format("cone angles {} and {}; expected 0 <= inner < outer <= pi / 2; {} and {} are used",
                               requested_inner, requested_outer, inner, outer)});
    }
    set_cone(inner, outer, light);
}

/// Returns `number` as a float; 0, with a warning, if it is negative.
float not_negative(const JsonValue& number, Sink& sink) {
    const float value = number.to_float();
    if (value < 0) sink.warn({number.location(), fmt::format("{}; expected at least 0, which is used", value)});
    return max(value, 0.0f);
}

} // namespace

std::span<const std::string_view> light_extensions() {
    static constexpr std::string_view kNames[] = {"KHR_lights_punctual"};
    return kNames;
}

Light read_light(const JsonValue& source, Sink& sink) {
    Light light;
    read_member(source, "name", sink, [&](const JsonValue& name) { light.name = name.to_string(); });
    const std::string type = source.string_or("type", "");
    if (type == "point")
        light.kind = LightKind::Point;
    else if (type == "spot")
        light.kind = LightKind::Spot;
    else if (type == "directional")
        light.kind = LightKind::Directional;
    else
        throw source.error(fmt::format("type \"{}\"; expected point, spot or directional", type));

    Rgb color = {1, 1, 1};
    float intensity = 1;
    read_member(source, "color", sink, [&](const JsonValue& member) {
        (void)member.to_floats<3>(); // throws
        const std::vector<JsonValue> channels = member.elements();
        color = {not_negative(channels[0], sink), not_negative(channels[1], sink), not_negative(channels[2], sink)};
    });
    read_member(source, "intensity", sink, [&](const JsonValue& member) { intensity = not_negative(member, sink); });
    constexpr float largest = std::numeric_limits<float>::max();
    light.intensity = {min(intensity * color.r, largest), min(intensity * color.g, largest),
                       min(intensity * color.b, largest)};
    read_member(source, "range", sink, [&](const JsonValue& member) {
        const float range = member.to_float();
        if (range < 0) throw member.error(fmt::format("{}; expected a number above 0", range));
        light.range = range;
    });
    if (light.kind != LightKind::Spot) return light;

    set_cone(0, kPi / 4, light);
    read_member(source, "spot", sink, [&](const JsonValue& spot) { read_cone(spot, light, sink); });
    return light;
}

bool place_light(const Transform& world_from_node, Light& light) {
    return transform_light(world_from_node, light) &&
           (!parts_of(light.kind).direction || length_squared(light.direction) > 0.5f);
}

} // namespace pertev::gltf
