#include "formats/mitsuba/emitters.h"
#include "formats/described/usable_values.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "base/message_text.h"
#include "formats/described/light_tables.h"
#include "formats/described/transforms.h"
#include "formats/files/closest_name.h"
#include "formats/mitsuba/projected_light.h"
#include "formats/mitsuba/skies.h"
#include "math/portable_math.h"

namespace pertev::mitsuba {
namespace {

constexpr std::array<std::string_view, 10> kEmitterTypes = {"area",     "point",  "spot",   "projector", "directional",
                                                            "constant", "envmap", "sunsky", "sun",       "sky"};
constexpr std::array<std::string_view, 3> kOtherEmitterTypes = {"timed_sunsky", "collimated", "directionalarea"};

Vec3 direction_of(const DoubleTransform& m, DoubleVec3 v) {
    return normalize_safely(to_float(DoubleVec3{dot(m.row0, v), dot(m.row1, v), dot(m.row2, v)}));
}

void add_light(Object& emitter, Reading& reading) {
    Parameters& parameters = emitter.parameters;
    Sink& sink = reading.sink();
    const DoubleTransform to_world = transform_of(emitter, "to_world", sink);
    PlacedLight placed;
    Light& light = placed.light;
    light.name = emitter.id;
    light.origin = fmt::format("{}:{}", emitter.location().file, emitter.location().line);
    placed.position = to_world.translation;
    placed.location = emitter.location();
    const bool is_directional = emitter.type == "directional";
    if (emitter.type != "projector") {
        light.intensity =
            read_color(emitter, is_directional ? "irradiance" : "intensity", ColorUse::Light, grey(1), reading);
    }
    if (emitter.type == "point") {
        light.kind = LightKind::Point;
        placed.position = parameters.vector("position", sink).value_or(placed.position);
    } else if (is_directional) {
        light.kind = LightKind::Directional;
        const auto direction = parameters.vector("direction", sink);
        light.direction = direction ? normalize_safely(to_float(*direction)) : direction_of(to_world, {0, 0, 1});
    } else if (!(emitter.type == "spot" ? set_spot : set_projector)(emitter, to_world, reading, light)) {
        return;
    }
    parameters.ignore({"sampling_weight"});
    parameters.leave_out_unknown(sink);
    described::add_light(std::move(placed), reading.parts.lights);
}

void add_infinite_light(Object& emitter, Reading& reading) {
    Parameters& parameters = emitter.parameters;
    Sink& sink = reading.sink();
    InfiniteLight light;
    light.location = emitter.location();
    light.layout = PanoramaLayout::AroundY;
    light.world_from_light = transform_of(emitter, "to_world", sink);
    parameters.ignore({"sampling_weight", "mis_compensation", "gamma", "cache", "radius"});
    if (emitter.type == "sunsky" || emitter.type == "sun" || emitter.type == "sky") {
        light.scale = grey(1);
        set_sky(emitter, reading, light);
    } else if (emitter.type == "constant") {
        light.scale = read_color(emitter, "radiance", ColorUse::Light, grey(1), reading);
    } else {
        light.scale = grey(static_cast<float>(std::max(parameters.number("scale", 1, sink), 0.0)));
        const std::string name = parameters.text("filename", "", sink);
        if (name.empty()) throw parameters.error("an envmap has no filename");
        const auto path = find_file(reading.context, emitter.location(), name);
        if (!path) throw parameters.error(fmt::format("there is no picture {}", shortened(name)));
        light.picture = path->string();
    }
    parameters.leave_out_unknown(sink);
    reading.parts.infinite_lights.push_back(std::move(light));
}

} // namespace

void add_emitter(Object& emitter, Reading& reading) {
    const std::string& type = emitter.type;
    try {
        if (type == "point" || type == "spot" || type == "directional" || type == "projector")
            return add_light(emitter, reading);
        const bool is_sky = type == "sunsky" || type == "sun" || type == "sky";
        if (is_sky || type == "constant" || type == "envmap") return add_infinite_light(emitter, reading);
        if (type == "area") throw emitter.parameters.error("an area emitter is in no shape");
        const bool is_known = std::ranges::find(kOtherEmitterTypes, type) != kOtherEmitterTypes.end();
        throw emitter.parameters.error(fmt::format("emitters of the type {} are not supported{}", shortened(type),
                                                   is_known ? "" : did_you_mean(type, kEmitterTypes)));
    } catch (const Error& error) {
        if (error.code() != ErrorCode::BadInput) throw;
        reading.sink().leave_out(error.remark().and_then("; the emitter is left out"));
    }
}

std::optional<AreaLight> read_area_light(Object& emitter, Textures& textures, Reading& reading) {
    Sink& sink = reading.sink();
    if (emitter.type != "area") {
        const bool is_known = std::ranges::find(kOtherEmitterTypes, emitter.type) != kOtherEmitterTypes.end();
        sink.leave_out({emitter.location(),
                        fmt::format("emitters of the type {} are left out of shapes{}", shortened(emitter.type),
                                    is_known ? "" : did_you_mean(emitter.type, kEmitterTypes))});
        return std::nullopt;
    }
    AreaLight light;
    light.location = emitter.location();
    const TextureValue radiance = textures.color(emitter, "radiance", ColorUse::Light, grey(1));
    light.radiance = radiance.factor;
    if (radiance.has_image()) {
        light.image = radiance;
        if (radiance.made >= 0 || !is_black(radiance.offset)) {
            light.image = {};
            sink.leave_out({emitter.location(), "the texture of an area emitter is not an image; its factor is used"});
        }
    }
    emitter.parameters.ignore({"sampling_weight"});
    emitter.parameters.leave_out_unknown(sink);
    if (is_light(light.radiance)) return light;
    leave_out_strength("an area", emitter.location(), sink);
    return std::nullopt;
}

} // namespace pertev::mitsuba
