#include "formats/pbrt/lights.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "base/message_text.h"
#include "formats/described/light_tables.h"
#include "formats/described/usable_values.h"
#include "formats/files/closest_name.h"
#include "formats/pbrt/colors.h"
#include "math/double_pi.h"
#include "math/portable_math.h"
#include "scene/orient_light.h"

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

/// Returns the colour `name` times `scale` and, if a power is stated, times that power over `unit_power`, which a light
/// of intensity 1 has.
Rgb strength_of(Parameters& parameters, std::string_view name, std::string_view power_name, double unit_power,
                const Context& context) {
    Rgb strength = scale_of(parameters, context) * light_color(parameters, name, grey(1), context);
    const double power = parameters.number(power_name, 0, context.sink);
    if (power > 0) strength = static_cast<float>(power / unit_power) * strength;
    return strength;
}

void set_spot(Parameters& parameters, const DoubleTransform& world_from_light, const Context& context, Light& light) {
    Sink& sink = context.sink;
    light.kind = LightKind::Spot;
    light.direction = direction_of(parameters, world_from_light, {0, 0, 0}, {0, 0, 1}, sink);
    const auto angle = [&](std::string_view name, double missing, double least) {
        const double degrees = parameters.number(name, missing, sink);
        return static_cast<float>(usable_cone(degrees, least, kWidestCone, name, parameters.location(), sink)) *
               (kPi / 180);
    };
    const float outer = angle("coneangle", 30, 0.1), edge = angle("conedeltaangle", 5, 0);
    light.cos_inner = cos(max(outer - edge, 0.0f));
    light.cos_outer = min(cos(outer), light.cos_inner - kSharpestEdge);
    const double from = static_cast<double>(light.cos_inner), to = static_cast<double>(light.cos_outer);
    light.intensity = strength_of(parameters, "I", "power", 2 * kPiDouble * ((1 - from) + (from - to) / 2), context);
    if (!(edge > 0)) return;
    light.up = {}; // any does for what is round
    set_table(make_round_table(outer,
                               [&](float at) {
                                   const float width = light.cos_inner - light.cos_outer;
                                   const float t = clamp((cos(at) - light.cos_outer) / width, 0.0f, 1.0f);
                                   return context.is_version_3 ? square(square(t)) : square(t) * (3 - 2 * t);
                               }),
              light);
    orient_light(light);
}

/// Reads the table of a light with a picture. Returns false, with a warning, if it is left out.
bool set_picture(bool is_projection, Parameters& parameters, const Context& context, Light& light) {
    Sink& sink = context.sink;
    const char* const key = context.is_version_3 ? "mapname" : "filename";
    const std::string name = parameters.text(key, "", sink);
    const double stated_fov = parameters.number("fov", context.is_version_3 ? 45 : 90, sink);
    IntensityTable table;
    const auto leave_out = [&](const std::string& why) {
        sink.leave_out({parameters.location(), why + "; the light is left out"});
        return false;
    };
    if (name.empty()) {
        if (is_projection && !context.is_version_3) return leave_out("a projection light has no filename");
        table.values = {.width = 1, .height = 1, .channels = 1, .pixels = {1.0f}};
    } else {
        std::optional<std::filesystem::path> path;
        try {
            path = context.access.find(base_of(context, parameters.location(), name), name, sink);
        } catch (const Error& error) {
            if (error.code() != ErrorCode::BadInput) throw;
            sink.leave_out(error.remark().and_then("; the light is left out"));
            return false;
        }
        if (!path) return leave_out(fmt::format("there is no picture {}", shortened(name)));
        std::optional<Image> picture = read_light_picture(*path, sink);
        if (!picture) return false;
        table.values = *std::move(picture);
    }
    table.filter = context.is_version_3 ? TableFilter::Linear : TableFilter::Nearest;
    Image& values = table.values;
    if (is_projection) {
        table.layout = TableLayout::Perspective; // the angle of view is that of the shorter side
        const double fov = usable_angle(stated_fov, 0.1, 179.0, "fov", parameters.location(), sink);
        const double half = static_cast<double>(tan(static_cast<float>(fov) * (kPi / 360)));
        set_view(half * std::max(static_cast<double>(values.width) / values.height, 1.0), table);
    } else if (!context.is_version_3) {
        table.layout = TableLayout::Octahedron;
        if (values.width != values.height)
            return leave_out("the picture of a goniometric light is not square, as the equal-area octahedron is");
        if (values.channels >= 3) { // its colours only average
            Image grey = {.width = values.width, .height = values.height, .channels = 1, .pixels = {}};
            for (std::size_t i = 0; i < values.pixels.size(); i += values.channels)
                grey.pixels.push_back((values.pixels[i] + values.pixels[i + 1] + values.pixels[i + 2]) / 3);
            values = std::move(grey);
        }
    }
    set_table(std::move(table), light);
    return true;
}

/// Reads a goniometric or projection light. Returns false, with a warning, if it is left out.
bool set_picture_light(bool is_projection, Parameters& parameters, const DoubleTransform& world_from_light,
                       const Context& context, Light& light) {
    Rgb strength = scale_of(parameters, context);
    if (!is_projection || context.is_version_3) strength = strength * light_color(parameters, "I", grey(1), context);
    light.intensity = strength;
    // pbrt-v3 shows the first row below.
    const LightAxes of_projection = {{1, 0, 0}, {0, context.is_version_3 ? -1.0 : 1.0, 0}, {0, 0, 1}};
    set_axes(is_projection ? of_projection : LightAxes{{1, 0, 0}, {0, 0, 1}, {0, 1, 0}}, world_from_light, light);
    if (!set_picture(is_projection, parameters, context, light)) return false;
    const double power = parameters.number("power", 0, context.sink);
    const double of_1 = static_cast<double>(luminance(light.table->integral));
    if (power > 0 && of_1 > 0) light.intensity = static_cast<float>(power / of_1) * strength;
    return true;
}

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
        light.intensity = strength_of(parameters, "I", "power", 4 * kPiDouble, context);
    } else if (type == "spot") {
        place({0, 0, 0});
        leave_out_stretch(world_from_light, parameters.location(), sink);
        set_spot(parameters, world_from_light, context, light);
    } else if (type == "goniometric" || type == "projection") {
        place({0, 0, 0});
        leave_out_stretch(world_from_light, parameters.location(), sink);
        if (!set_picture_light(type == "projection", parameters, world_from_light, context, light)) return std::nullopt;
    } else if (type == "distant") {
        light.kind = LightKind::Directional;
        light.direction = direction_of(parameters, world_from_light, {0, 0, 0}, {0, 0, 1}, sink);
        light.intensity = strength_of(parameters, "L", "illuminance", 1, context);
    } else {
        sink.leave_out({parameters.location(), fmt::format("lights of the type {} are left out{}", shortened(type),
                                                           did_you_mean(type, kKnown))});
        return std::nullopt;
    }
    parameters.ignore({"samples", "nsamples"});
    parameters.leave_out_unknown(sink);
    return light;
}

} // namespace pertev::pbrt
