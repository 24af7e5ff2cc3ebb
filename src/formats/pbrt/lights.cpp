#include "formats/pbrt/lights.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "base/message_text.h"
#include "formats/described/usable_values.h"
#include "formats/files/closest_name.h"
#include "formats/pbrt/colors.h"
#include "math/portable_math.h"

namespace pertev::pbrt {
namespace {

DoubleVec3 transform_direction(const DoubleTransform& m, DoubleVec3 v) {
    return {dot(m.row0, v), dot(m.row1, v), dot(m.row2, v)};
}

/// Returns the factor `scale`, which is a number in pbrt-v4 and may be a colour in v3.
Rgb scale_of(Parameters& parameters, const Context& context) {
    return plain_color(parameters, "scale", context).value_or(grey(1));
}

/// Returns the direction from `from` to `to`, transformed.
Vec3 direction_of(Parameters& parameters, const DoubleTransform& world_from_light, DoubleVec3 from, DoubleVec3 to,
                  Sink& sink) {
    from = parameters.vector("from", sink).value_or(from);
    to = parameters.vector("to", sink).value_or(to);
    return normalize_safely(to_float(transform_direction(world_from_light, to - from)));
}

/// The colour `name` times `scale` and, if a power is stated, that over `unit_power`, of the light of intensity 1.
Rgb strength_of(Parameters& parameters, std::string_view name, std::string_view power_name, double unit_power,
                const Context& context) {
    Rgb strength = scale_of(parameters, context) * light_color(parameters, name, grey(1), context);
    const double power = parameters.number(power_name, 0, context.sink);
    if (power > 0) strength = static_cast<float>(power / unit_power) * strength;
    return strength;
}

constexpr double kPiExact = 3.14159265358979323846;

} // namespace

std::optional<AreaLight> read_area_light(const std::string& type, Parameters& parameters, Textures& textures,
                                         const Context& context) {
    if (type != "diffuse" && type != "area") {
        context.sink.leave_out(
            {parameters.location(),
             fmt::format("area lights of the type {} are left out; expected diffuse", shortened(type))});
        return std::nullopt;
    }
    AreaLight light;
    light.location = parameters.location();
    light.radiance = scale_of(parameters, context) * light_color(parameters, "L", grey(1), context);
    light.is_two_sided = parameters.truth("twosided", false, context.sink);
    light.power = std::max(parameters.number("power", 0, context.sink), 0.0);
    if (const std::string picture = parameters.text("filename", "", context.sink); !picture.empty())
        light.image = textures.image_file(parameters.location(), picture);
    parameters.ignore({"samples", "nsamples"});
    parameters.leave_out_unknown(context.sink);
    if (is_light(light.radiance)) return light;
    leave_out_strength("an area", parameters.location(), context.sink);
    return std::nullopt;
}

std::optional<InfiniteLight> read_infinite_light(Parameters& parameters, const DoubleTransform& world_from_light,
                                                 const Context& context) {
    InfiniteLight light;
    light.location = parameters.location();
    light.world_from_light = world_from_light;
    const std::string of_version_3 = parameters.text("mapname", "", context.sink);
    const std::string name = parameters.text("filename", of_version_3, context.sink);
    if (!of_version_3.empty()) light.layout = PanoramaLayout::AroundZ;
    light.scale = scale_of(parameters, context) * light_color(parameters, "L", grey(1), context);
    light.illuminance = std::max(parameters.number("illuminance", 0, context.sink), 0.0);
    parameters.leave_out({"portal"}, "it only guides samples, and cuts light from elsewhere off", context.sink);
    parameters.ignore({"samples", "nsamples"});
    parameters.leave_out_unknown(context.sink);
    if (name.empty()) return light;
    try {
        const auto found = context.access.find(base_of(context, light.location, name), name, context.sink);
        if (found) {
            light.picture = found->string();
            return light;
        }
        context.sink.leave_out(
            {light.location, fmt::format("there is no picture {}; the infinite light is left out", shortened(name))});
    } catch (const Error& error) {
        if (error.code() != ErrorCode::BadInput) throw;
        context.sink.leave_out(error.remark().and_then("; the infinite light is left out"));
    }
    return std::nullopt;
}

std::optional<Light> read_light(const std::string& type, Parameters& parameters,
                                const DoubleTransform& world_from_light, const Context& context) {
    Sink& sink = context.sink;
    constexpr std::array<std::string_view, 6> kKnown = {"point",    "spot",        "distant",
                                                        "infinite", "goniometric", "projection"};
    Light light;
    light.origin = fmt::format("{}:{}", parameters.location().file, parameters.location().line);
    const auto place = [&](DoubleVec3 from) {
        light.position = to_float(transform_point(world_from_light, parameters.vector("from", sink).value_or(from)));
    };
    if (type == "point") {
        light.kind = LightKind::Point;
        place({0, 0, 0});
        light.intensity = strength_of(parameters, "I", "power", 4 * kPiExact, context);
    } else if (type == "spot") {
        light.kind = LightKind::Spot;
        place({0, 0, 0});
        light.direction = direction_of(parameters, world_from_light, {0, 0, 0}, {0, 0, 1}, sink);
        const auto cone = static_cast<float>(std::clamp(parameters.number("coneangle", 30, sink), 0.1, 89.9));
        const auto edge = static_cast<float>(std::clamp(parameters.number("conedeltaangle", 5, sink), 0.0, 89.9));
        if (edge > 0)
            sink.warn({FileLocation{parameters.location().file},
                       "the edges of spots fall off as those of glTF, darker than pbrt's"});
        light.cos_inner = cos(max(cone - edge, 0.0f) * (kPi / 180));
        light.cos_outer = min(cos(cone * (kPi / 180)), light.cos_inner - kSharpestEdge);
        const double inner = static_cast<double>(light.cos_inner), outer = static_cast<double>(light.cos_outer);
        light.intensity =
            strength_of(parameters, "I", "power", 2 * kPiExact * ((1 - inner) + (inner - outer) / 2), context);
    } else if (type == "distant") {
        light.kind = LightKind::Directional;
        light.direction = direction_of(parameters, world_from_light, {0, 0, 0}, {0, 0, 1}, sink);
        light.intensity = strength_of(parameters, "L", "illuminance", 1, context);
    } else {
        const bool is_known = std::ranges::find(kKnown, type) != kKnown.end();
        sink.leave_out({parameters.location(), fmt::format("lights of the type {} are left out{}", shortened(type),
                                                           is_known ? "" : did_you_mean(type, kKnown))});
        return std::nullopt;
    }
    parameters.ignore({"samples", "nsamples"});
    parameters.leave_out_unknown(sink);
    return light;
}

} // namespace pertev::pbrt
