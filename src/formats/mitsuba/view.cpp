#include "formats/mitsuba/view.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "base/limits.h"
#include "base/message_text.h"
#include "formats/described/transforms.h"
#include "formats/described/usable_values.h"
#include "formats/files/closest_name.h"
#include "formats/mitsuba/clipping.h"
#include "formats/mitsuba/parse_values.h"
#include "math/double_pi.h"
#include "math/portable_math.h"
#include "scene/suggested_setting.h"

namespace pertev::mitsuba {
namespace {

struct FilmSize {
    int64_t width = 768, height = 576;
    double aspect() const { return static_cast<double>(width) / static_cast<double>(height); }
};

constexpr std::array<std::string_view, 29> kOtherIntegrators = {"ao",
                                                                "bdpt",
                                                                "depth",
                                                                "direct_projective",
                                                                "emission",
                                                                "erpt",
                                                                "field",
                                                                "irrcache",
                                                                "mlt",
                                                                "motion",
                                                                "photonmapper",
                                                                "ppm",
                                                                "prb",
                                                                "pssmlt",
                                                                "prb_basic",
                                                                "prb_projective",
                                                                "prbvolpath",
                                                                "ptracer",
                                                                "sppm",
                                                                "stokes",
                                                                "vpl",
                                                                "volpath_simple",
                                                                "volprim_rf_basic",
                                                                "adaptive",
                                                                "aov",
                                                                "moment",
                                                                "multichannel",
                                                                "albedo",
                                                                "normal"};

float tangent_of_half(double degrees) { return tan(static_cast<float>(degrees) * (kPi / 360)); }

/// Leaves out the type of an object, such as "the sampler sobl", if it is not one of `known`.
void leave_out_unknown_type(const Object& object, std::span<const std::string_view> known, Sink& sink) {
    if (std::ranges::find(known, object.type) != known.end()) return;
    sink.leave_out({object.location(), fmt::format("{} is unknown and left out{}", object.parameters.what(),
                                                   did_you_mean(object.type, known))});
}

using Suggestions = std::vector<SuggestedSetting>;

void suggest_filter(Object& film, Reading& reading, Suggestions& suggested) {
    const std::vector<Object*> filters = objects_in(film, "rfilter", reading);
    Sink& sink = reading.sink();
    if (filters.empty()) return;
    Object& filter = *filters.front();
    Parameters& parameters = filter.parameters;
    std::string name;
    double radius = 0;
    if (filter.type == "box") {
        name = "box", radius = parameters.number("radius", 0.5, sink);
    } else if (filter.type == "tent") {
        name = "tent", radius = parameters.number("radius", 1, sink);
    } else if (filter.type == "gaussian") {
        name = "gaussian", radius = 3 * parameters.number("stddev", 0.5, sink);
    } else {
        parameters.ignore({"radius", "lobes", "b", "c", "B", "C"});
        constexpr std::array<std::string_view, 6> kFilters = {"box",      "tent",       "gaussian",
                                                              "mitchell", "catmullrom", "lanczos"};
        sink.leave_out({filter.location(), fmt::format("the filter {} is left out; the default is used{}",
                                                       shortened(filter.type), did_you_mean(filter.type, kFilters))});
    }
    parameters.leave_out_unknown(sink);
    if (!(radius > 0)) return;
    suggested.push_back({"filter", name});
    suggested.push_back({"filter_radius", fmt::format("{:.6g}", radius)});
}

FilmSize size_of(Object& sensor, Reading& reading, Suggestions& suggested) {
    Sink& sink = reading.sink();
    FilmSize size;
    const std::vector<Object*> films = objects_in(sensor, "film", reading);
    const auto suggest_size = [&] { suggested.push_back({"size", fmt::format("{}x{}", size.width, size.height)}); };
    if (films.empty()) return suggest_size(), size;
    Object& film = *films.front();
    Parameters& parameters = film.parameters;
    size.width = std::clamp<int64_t>(parameters.integer("width", size.width, sink), 1, kMaxImageSide);
    size.height = std::clamp<int64_t>(parameters.integer("height", size.height, sink), 1, kMaxImageSide);
    constexpr std::array<std::string_view, 5> kFilms = {"hdrfilm", "ldrfilm", "mfilm", "specfilm", "tiledhdrfilm"};
    leave_out_unknown_type(film, kFilms, sink);
    const bool is_cropped = parameters.integer("crop_offset_x", 0, sink) != 0 ||
                            parameters.integer("crop_offset_y", 0, sink) != 0 ||
                            parameters.integer("crop_width", size.width, sink) != size.width ||
                            parameters.integer("crop_height", size.height, sink) != size.height;
    if (is_cropped)
        parameters.leave_out({"crop_offset_x", "crop_offset_y", "crop_width", "crop_height"},
                             "the whole picture is rendered", sink);
    parameters.ignore({"crop_offset_x", "crop_offset_y", "crop_width", "crop_height"});
    parameters.ignore({"file_format", "pixel_format", "component_format", "filename", "banner", "gamma", "exposure",
                       "tonemap_method", "attach_log", "high_quality_edges", "sample_border", "compensate", "metadata",
                       "key", "burn"});
    suggest_size();
    suggest_filter(film, reading, suggested);
    parameters.leave_out_unknown(sink);
    return size;
}

void set_perspective(Object& sensor, const FilmSize& size, Camera& camera, Sink& sink) {
    Parameters& parameters = sensor.parameters;
    const double across = tangent_across(sensor, size.aspect(), sink), high = across / size.aspect();
    camera.fov_y = 2 * atan(static_cast<float>(high));
    const double offset_x = parameters.number("principal_point_offset_x", 0, sink),
                 offset_y = parameters.number("principal_point_offset_y", 0, sink);
    if (offset_x == 0 && offset_y == 0) return;
    const auto width = static_cast<double>(size.width), height = static_cast<double>(size.height);
    camera.intrinsics = Intrinsics{.focal_x = width / (2 * across),
                                   .focal_y = height / (2 * high),
                                   .centre_x = width * (0.5 - offset_x),
                                   .centre_y = height * (0.5 - offset_y),
                                   .width = static_cast<uint32_t>(size.width),
                                   .height = static_cast<uint32_t>(size.height)};
}

std::optional<Camera> make_camera(Object& sensor, const FilmSize& size, const DoubleTransform& scene_from_world,
                                  DoubleVec3 origin, Reading& reading) {
    Sink& sink = reading.sink();
    Parameters& parameters = sensor.parameters;
    constexpr std::array<std::string_view, 3> kKnown = {"perspective", "thinlens", "orthographic"};
    if (std::ranges::find(kKnown, sensor.type) == kKnown.end()) {
        sink.leave_out({sensor.location(), fmt::format("sensors of the type {} are left out{}", shortened(sensor.type),
                                                       did_you_mean(sensor.type, kKnown))});
        return std::nullopt;
    }
    Camera camera;
    camera.name = sensor.id;
    camera.origin = fmt::format("{}:{}", sensor.location().file, sensor.location().line);
    camera.aspect = static_cast<float>(size.aspect());
    const DoubleTransform to_world = transform_of(sensor, "to_world", sink);
    DoubleTransform placed = compose(compose(scene_from_world, to_world), scale_by({-1, 1, -1}));
    placed.translation = placed.translation - origin;
    const auto rigid = is_finite(placed) && determinant(placed) > 0 ? without_scale(to_float(placed)) : std::nullopt;
    if (!rigid) {
        sink.leave_out(
            {sensor.location(), "the sensor is left out, because its transform has no direction or mirrors"});
        return std::nullopt;
    }
    camera.world_from_camera = *rigid;
    if (sensor.type == "orthographic") {
        const DoubleVec3 x = {to_world.row0.x, to_world.row1.x, to_world.row2.x},
                         y = {to_world.row0.y, to_world.row1.y, to_world.row2.y};
        const double across = std::sqrt(dot(x, x)), high = std::sqrt(dot(y, y));
        camera.projection = Projection::Orthographic;
        camera.ortho_height = static_cast<float>(2 * across / size.aspect());
        if (std::abs(high - across) > 1e-4 * across || std::abs(dot(x, y)) > 1e-4 * across * high)
            sink.leave_out({sensor.location(), "the scale along y of an orthographic sensor, or its skew, is left out; "
                                               "that along x is used both ways"});
    } else {
        set_perspective(sensor, size, camera, sink);
    }
    if (sensor.type == "thinlens") {
        const auto length = [&](const char* name) {
            return min(static_cast<float>(parameters.number(name, 0, sink)), kMaxCoordinate);
        };
        const float radius = length("aperture_radius"), focus = length("focus_distance");
        if (radius > 0 && focus > 0) camera.aperture_radius = radius, camera.focus_distance = focus;
    }
    parameters.ignore({"near_clip", "far_clip", "shutter_open", "shutter_close", "focus_distance", "aperture_radius"});
    parameters.leave_out_unknown(sink);
    if (const std::string fault = fault_of(camera); !fault.empty()) {
        sink.leave_out({sensor.location(), fmt::format("the sensor is left out, because {}", fault)});
        return std::nullopt;
    }
    return camera;
}

void suggest_samples(Object& sensor, Reading& reading, Suggestions& suggested) {
    for (Object* const sampler : objects_in(sensor, "sampler", reading)) {
        const int64_t count = sampler->parameters.integer("sample_count", 0, reading.sink());
        if (count > 0) suggested.push_back({"spp", fmt::format("{}", std::min<int64_t>(count, kMaxSamplesPerPixel))});
        constexpr std::array<std::string_view, 8> kSamplers = {"independent", "stratified", "multijitter", "orthogonal",
                                                               "ldsampler",   "halton",     "hammersley",  "sobol"};
        leave_out_unknown_type(*sampler, kSamplers, reading.sink());
        sampler->parameters.ignore({"seed", "scramble", "dimension", "jitter"});
        sampler->parameters.leave_out_unknown(reading.sink());
    }
}

/// Leaves out the clipping planes of a sensor that cut anything.
void leave_out_clipping(Object& sensor, const Camera& camera, const Scene& scene, Sink& sink) {
    Parameters& parameters = sensor.parameters;
    const double near = parameters.number("near_clip", 0.01, sink), far = parameters.number("far_clip", 10000, sink);
    const Clipping cut = find_clipping(scene, camera, static_cast<float>(near), static_cast<float>(far));
    const auto leave_out = [&](const char* name, double distance, const char* where) {
        const Parameter* const stated = parameters.find(name);
        sink.leave_out({stated != nullptr ? parameters.location_of(*stated) : sensor.location(),
                        fmt::format("the {} of {} is left out; {} is visible", name, distance, where)});
    };
    if (cut.is_near) leave_out("near_clip", near, "what is nearer");
    if (cut.is_far) leave_out("far_clip", far, "what is farther");
}

/// Adds what another sensor than the first suggests, as far as it differs from what the first one does.
void add_suggestions_of(const Camera& camera, const Suggestions& suggested, Scene& scene) {
    for (const SuggestedSetting& own : suggested) {
        const auto first = std::ranges::find(scene.suggested, own.name, &SuggestedSetting::name);
        if (first != scene.suggested.end() && first->text == own.text) continue;
        scene.suggested.push_back({suggested_for_camera(own.name, camera.name), own.text});
    }
}

void suggest_depth(Object* integrator, Reading& reading, Scene& scene) {
    Sink& sink = reading.sink();
    constexpr std::array<std::string_view, 4> kWrappers = {"moment", "aov", "multichannel", "adaptive"};
    for (int i = 0; integrator != nullptr && i < 8; ++i) {
        if (std::ranges::find(kWrappers, integrator->type) == kWrappers.end()) break;
        const std::vector<Object*> inner = objects_in(*integrator, "integrator", reading);
        integrator = inner.empty() ? nullptr : inner.front();
    }
    if (integrator == nullptr) return;
    Parameters& parameters = integrator->parameters;
    int64_t depth = parameters.integer("max_depth", -1, sink); // counts the emitter's vertex
    if (integrator->type == "direct") depth = 2;
    depth = depth < 0 ? kMaxPathDepth - 1 : std::max<int64_t>(depth - 1, 0);
    scene.suggested.push_back({"max_depth", fmt::format("{}", std::min<int64_t>(depth, kMaxPathDepth - 1))});
    constexpr std::array<std::string_view, 4> kPaths = {"path", "volpath", "volpathmis", "direct"};
    if (std::ranges::find(kPaths, integrator->type) == kPaths.end()) {
        if (std::ranges::find(kOtherIntegrators, integrator->type) == kOtherIntegrators.end())
            return leave_out_unknown_type(*integrator, kPaths, sink);
        sink.warn({integrator->location(),
                   fmt::format("the integrator {} has no effect; paths are traced", shortened(integrator->type))});
        return;
    }
    if (parameters.truth("hide_emitters", false, sink))
        parameters.leave_out({"hide_emitters"}, "emitters are visible", sink);
    parameters.ignore({"rr_depth", "strict_normals", "shading_samples", "emitter_samples", "bsdf_samples",
                       "samples_per_pass", "timeout", "block_size"});
    parameters.leave_out_unknown(sink);
}

} // namespace

double tangent_across(Object& object, double aspect, Sink& sink) {
    Parameters& parameters = object.parameters;
    double degrees = parameters.number("fov", 0, sink);
    std::string axis = parameters.text("fov_axis", "x", sink);
    std::string focal = parameters.text("focal_length", "", sink);
    if (!parameters.has("fov")) { // that of a film of 36 x 24 mm
        if (focal.ends_with("mm")) focal.resize(focal.size() - 2);
        const std::vector<double> mm = parse_numbers(focal);
        const double length = mm.size() == 1 && mm[0] > 0 ? mm[0] : 50.0;
        degrees = static_cast<double>(atan(static_cast<float>(std::sqrt(36.0 * 36 + 24.0 * 24) / (2 * length)))) *
                  (360.0 / kPiDouble);
        axis = "diagonal";
    }
    if (!(degrees > 0 && degrees < 180)) {
        sink.leave_out(
            {object.location(), fmt::format("the fov of {} is {} and left out; expected above 0 and below 180",
                                            parameters.what(), degrees)});
        degrees = 45;
    }
    if (axis == "smaller") axis = aspect > 1 ? "y" : "x";
    if (axis == "larger") axis = aspect > 1 ? "x" : "y";
    double tangent = static_cast<double>(tangent_of_half(degrees));
    if (axis == "y") {
        tangent *= aspect;
    } else if (axis == "diagonal") {
        tangent *= aspect / std::sqrt(aspect * aspect + 1);
    } else if (axis != "x") {
        constexpr std::array<std::string_view, 5> kAxes = {"x", "y", "diagonal", "smaller", "larger"};
        sink.leave_out({object.location(), fmt::format("the fov_axis {} is left out; x is used{}", shortened(axis),
                                                       did_you_mean(axis, kAxes))});
    }
    return tangent;
}

DoubleTransform scene_from_world(const View& view, Sink& sink) {
    if (view.sensors.empty()) return {};
    return determinant(transform_of(*view.sensors.front(), "to_world", sink)) < 0 ? scale_by({-1, 1, 1})
                                                                                  : DoubleTransform();
}

void add_view(const View& view, Reading& reading, Scene& scene) {
    const DoubleTransform mirrored = scene_from_world(view, reading.sink());
    for (Object* const sensor : view.sensors) {
        try {
            Suggestions suggested;
            const FilmSize size = size_of(*sensor, reading, suggested);
            suggest_samples(*sensor, reading, suggested);
            auto camera = make_camera(*sensor, size, mirrored, scene.origin_in_file, reading);
            if (camera && camera->name.empty()) camera->name = fmt::format("{} {}", sensor->type, scene.cameras.size());
            if (sensor == view.sensors.front()) {
                scene.suggested.insert(scene.suggested.end(), suggested.begin(), suggested.end());
            } else if (camera) {
                add_suggestions_of(*camera, suggested, scene);
            }
            if (camera) {
                leave_out_clipping(*sensor, *camera, scene, reading.sink());
                scene.cameras.push_back(*std::move(camera));
            }
        } catch (const Error& error) {
            if (error.code() != ErrorCode::BadInput) throw;
            reading.sink().leave_out(error.remark().and_then("; the sensor is left out"));
        }
    }
    suggest_depth(view.integrator, reading, scene);
}

} // namespace pertev::mitsuba
