#include "formats/pbrt/camera.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "base/limits.h"
#include "base/message_text.h"
#include "formats/described/transforms.h"
#include "formats/described/usable_values.h"
#include "formats/files/closest_name.h"
#include "formats/spectra/spectrum.h"
#include "math/portable_math.h"

namespace pertev::pbrt {
namespace {

struct FilmSize {
    int64_t width = 1280, height = 720;
};

/// The picture's borders on the plane at distance 1 of a camera whose half angle has the tangent 1.
struct Screen {
    double left, right, low, high;
};

float tangent_of_half(double degrees) { return tan(static_cast<float>(degrees) * (kPi / 360)); }

constexpr std::array<std::string_view, 18> kSensors = {
    "cie1931",       "canon_eos_100d",    "canon_eos_1dx_mkii", "canon_eos_200d",     "canon_eos_200d_mkii",
    "canon_eos_5d",  "canon_eos_5d_mkii", "canon_eos_5d_mkiii", "canon_eos_5d_mkiv",  "canon_eos_5ds",
    "canon_eos_m",   "nikon_d810",        "nikon_d850",         "hasselblad_l1d_20c", "sony_ilce_6400",
    "sony_ilce_7m3", "sony_ilce_7rm3",    "sony_ilce_9"};

/// Reads the sensor. pbrt fits each so that light of the white balance's temperature is white and as bright as for the
/// observer, so that it changes no exposure, and of the colours only those that its filters see otherwise.
void read_sensor(Parameters& film, Sink& sink) {
    const std::string sensor = film.text("sensor", "cie1931", sink);
    const double kelvins = film.number("whitebalance", 0, sink);
    if (std::ranges::find(kSensors, sensor) == kSensors.end()) {
        sink.leave_out({film.location(), fmt::format("the sensor {} is left out; colours are those of the observer{}",
                                                     shortened(sensor), did_you_mean(sensor, kSensors))});
    } else if (sensor != kSensors.front()) {
        sink.leave_out({film.location(), fmt::format("the filters of the sensor {} are left out; colours are those of "
                                                     "the observer, at the same exposure",
                                                     sensor)});
    }
    constexpr double kWhiteOfRec709 = 6500;
    if (!(kelvins > 0) || kelvins == kWhiteOfRec709) return;
    const Rgb white = color_of_unit_light(black_body(std::clamp(kelvins, 1000.0, 25000.0)));
    sink.leave_out(
        {film.location(),
         fmt::format("the white balance of {:.6g} K is left out; such light has about the colour {:.2f},{:.2f},"
                     "{:.2f}, where pbrt shows white",
                     kelvins, white.r, white.g, white.b)});
}

/// Returns how long the shutter of a camera is open; 1 if it never opens.
double shutter_time(View& view, Sink& sink) {
    if (!view.camera) return 1;
    Parameters& camera = view.camera->parameters;
    const double seconds = camera.number("shutterclose", 1, sink) - camera.number("shutteropen", 0, sink);
    if (seconds > 0) return seconds;
    sink.leave_out({camera.location(), "shutter times are ignored: the shutter never opens"});
    return 1;
}

FilmSize read_film(View& view, const Context& context, Scene& scene) {
    Sink& sink = context.sink;
    FilmSize size;
    const double seconds = context.is_version_3 ? 1 : shutter_time(view, sink);
    const auto suggest_exposure = [&](double exposure) {
        if (exposure > 0 && exposure != 1)
            scene.suggested.push_back({"exposure", fmt::format("{:.6g}", log2(static_cast<float>(exposure)))});
    };
    if (!view.film) {
        suggest_exposure(seconds);
        return size;
    }
    Parameters& film = view.film->parameters;
    if (context.is_version_3) size = {640, 480};
    size.width = std::clamp<int64_t>(film.integer("xresolution", size.width, sink), 1, kMaxImageSide);
    size.height = std::clamp<int64_t>(film.integer("yresolution", size.height, sink), 1, kMaxImageSide);
    scene.suggested.push_back({"size", fmt::format("{}x{}", size.width, size.height)});
    film.leave_out({"cropwindow", "pixelbounds"}, "the whole picture is rendered", sink);
    const double iso = film.number("iso", 100, sink);
    suggest_exposure(film.number("scale", 1, sink) * iso / 100 * seconds);
    const double most = film.number(context.is_version_3 ? "maxsampleluminance" : "maxcomponentvalue", 0, sink);
    if (most > 0 && most < 1e30) scene.suggested.push_back({"clamp", fmt::format("{:.6g}", most)});
    read_sensor(film, sink);
    constexpr std::array<std::string_view, 4> kFilms = {"rgb", "gbuffer", "spectral", "image"};
    leave_out_unknown_type(*view.film, "film", kFilms, sink);
    film.ignore({"filename", "savefp16", "diagonal", "lambdamin", "lambdamax", "nbuckets", "coordinatesystem"});
    film.leave_out_unknown(sink);
    return size;
}

void suggest_filter(View& view, const Context& context, Scene& scene) {
    if (!view.filter) return;
    Parameters& filter = view.filter->parameters;
    struct Name {
        std::string_view theirs, ours;
        double radius;
    };
    constexpr std::array<Name, 3> kNames = {
        {{"box", "box", 0.5}, {"triangle", "tent", 2}, {"gaussian", "gaussian", 1.5}}};
    const std::string& type = view.filter->type;
    const auto* const found = std::ranges::find(kNames, type, &Name::theirs);
    const char* const radius_name = filter.contains("xwidth") ? "xwidth" : "xradius";
    const double radius = filter.number(radius_name, found == kNames.end() ? 2 : found->radius, context.sink);
    filter.ignore({"xradius", "xwidth", "yradius", "ywidth", "alpha", "sigma", "B", "C", "tau"});
    filter.leave_out_unknown(context.sink);
    if (found == kNames.end()) {
        context.sink.leave_out(
            {filter.location(), fmt::format("the filter {} is left out; the default is used", shortened(type))});
        return;
    }
    if (!(radius > 0)) return;
    scene.suggested.push_back({"filter", std::string(found->ours)});
    scene.suggested.push_back({"filter_radius", fmt::format("{:.6g}", radius)});
}

void suggest_settings(View& view, const Context& context, Scene& scene) {
    Sink& sink = context.sink;
    if (view.sampler) {
        Parameters& sampler = view.sampler->parameters;
        const auto many = [](int64_t n) { return std::min<int64_t>(n, kMaxSamplesPerPixel); };
        const int64_t across = sampler.integer("xsamples", 0, sink), down = sampler.integer("ysamples", 0, sink);
        const int64_t samples =
            across > 0 && down > 0 ? many(across) * many(down) : sampler.integer("pixelsamples", 0, sink);
        if (samples > 0) scene.suggested.push_back({"spp", fmt::format("{}", many(samples))});
        constexpr std::array<std::string_view, 11> kSamplers = {
            "halton", "independent", "paddedsobol",    "pmj02bn",    "sobol", "stratified",
            "zsobol", "02sequence",  "lowdiscrepancy", "maxmindist", "random"};
        leave_out_unknown_type(*view.sampler, "sampler", kSamplers, sink);
        sampler.ignore({"jitter", "randomization", "seed", "dimensions", "samplepixelcenter"});
        sampler.leave_out_unknown(sink);
    }
    int64_t depth = 5; // pbrt renders this depth without one
    if (view.integrator) {
        Parameters& integrator = view.integrator->parameters;
        depth = std::max<int64_t>(integrator.integer("maxdepth", depth, sink), 0);
        constexpr std::array<std::string_view, 14> kIntegrators = {
            "path",    "volpath",   "simplepath", "simplevolpath",    "bdpt",     "mlt",           "sppm", "ao",
            "whitted", "lightpath", "randomwalk", "ambientocclusion", "function", "directlighting"};
        leave_out_unknown_type(*view.integrator, "integrator", kIntegrators, sink);
        constexpr std::array<std::string_view, 5> kWithoutGlobalLight = {"ao", "ambientocclusion", "directlighting",
                                                                         "function", "whitted"};
        if (std::ranges::find(kWithoutGlobalLight, view.integrator->type) != kWithoutGlobalLight.end())
            sink.leave_out(
                {integrator.location(), fmt::format("{} is left out; light is path traced", integrator.what())});
        integrator.ignore({"regularize",
                           "lightsampler",
                           "lightsamplestrategy",
                           "rrthreshold",
                           "pixelbounds",
                           "visualizestrategies",
                           "visualizeweights",
                           "samplelights",
                           "samplebsdf",
                           "cossample",
                           "maxdistance",
                           "nsamples",
                           "bootstrapsamples",
                           "chains",
                           "mutationsperpixel",
                           "largestepprobability",
                           "sigma",
                           "photonsperiteration",
                           "radius",
                           "seed",
                           "iterations",
                           "numiterations",
                           "imagewritefrequency",
                           "strategy",
                           "function",
                           "skipbad"});
        integrator.leave_out_unknown(sink);
    }
    scene.suggested.push_back({"max_depth", fmt::format("{}", std::min<int64_t>(depth, kMaxPathDepth - 1))});
    suggest_filter(view, context, scene);
}

/// Returns the borders of the picture: one unit from the middle of the shorter side, or what the file states.
Screen screen_of(Parameters& parameters, double aspect, Sink& sink) {
    Screen screen = aspect >= 1 ? Screen{-aspect, aspect, -1, 1} : Screen{-1, 1, -1 / aspect, 1 / aspect};
    const std::span<const double> stated = parameters.numbers("screenwindow", 4, sink);
    if (stated.empty()) return screen;
    const Screen wanted = {stated[0], stated[1], stated[2], stated[3]};
    if (wanted.left < wanted.right && wanted.low < wanted.high && std::isfinite(wanted.right - wanted.left) &&
        std::isfinite(wanted.high - wanted.low))
        return wanted;
    sink.leave_out(
        {parameters.location(), "the screenwindow of a camera is left out; expected left, right, low and high"});
    return screen;
}

void set_perspective(Parameters& parameters, const Screen& screen, const FilmSize& size, Camera& camera, Sink& sink) {
    double degrees = parameters.number("fov", 90, sink);
    if (parameters.has("halffov")) degrees = 2 * parameters.number("halffov", 45, sink);
    if (!(degrees > 0 && degrees < 180)) {
        sink.leave_out(
            {parameters.location(),
             fmt::format("the fov of a camera is {} and left out; expected above 0 and below 180", degrees)});
        degrees = 90;
    }
    const double tangent = static_cast<double>(tangent_of_half(degrees));
    const double high = tangent * screen.high, low = tangent * screen.low;
    camera.fov_y = 2 * atan(static_cast<float>(0.5 * (high - low)));
    const double across = tangent * (screen.right - screen.left);
    const double pixel_aspect =
        across / static_cast<double>(size.width) / ((high - low) / static_cast<double>(size.height));
    const bool is_central = std::abs(screen.left + screen.right) < 1e-9 * (screen.right - screen.left) &&
                            std::abs(screen.low + screen.high) < 1e-9 * (screen.high - screen.low);
    if (is_central && std::abs(pixel_aspect - 1) < 1e-6) return;
    const auto width = static_cast<double>(size.width), height = static_cast<double>(size.height);
    camera.intrinsics = Intrinsics{.focal_x = width / across,
                                   .focal_y = height / (high - low),
                                   .centre_x = -tangent * screen.left * width / across,
                                   .centre_y = high * height / (high - low),
                                   .width = static_cast<uint32_t>(size.width),
                                   .height = static_cast<uint32_t>(size.height)};
}

std::optional<Camera> make_camera(View& view, const FilmSize& size, DoubleVec3 origin, const Context& context) {
    Sink& sink = context.sink;
    Parameters& parameters = view.camera->parameters;
    const std::string& type = view.camera->type;
    Camera camera;
    camera.name = "camera";
    camera.origin = fmt::format("{}:{}", parameters.location().file, parameters.location().line);
    camera.aspect = static_cast<float>(static_cast<double>(size.width) / static_cast<double>(size.height));
    const DoubleTransform world_from_camera = inverse(view.camera_from_world);
    DoubleTransform placed = compose(compose(scene_from_world(view), world_from_camera), scale_by({1, 1, -1}));
    placed.translation = placed.translation - origin;
    const auto rigid = is_finite(placed) ? without_scale(to_float(placed)) : std::nullopt;
    if (!rigid) {
        sink.leave_out({parameters.location(), "the camera is left out, because its transform has no direction"});
        return std::nullopt;
    }
    camera.world_from_camera = *rigid;
    const auto length_of = [&](double DoubleVec3::*column) {
        const DoubleVec3 v = {placed.row0.*column, placed.row1.*column, placed.row2.*column};
        return std::sqrt(dot(v, v));
    };
    const double aspect =
        parameters.number("frameaspectratio", static_cast<double>(size.width) / static_cast<double>(size.height), sink);
    const Screen screen = screen_of(parameters, aspect > 0 ? aspect : 1.0, sink);
    if (type == "orthographic") {
        camera.projection = Projection::Orthographic;
        camera.ortho_height = static_cast<float>(
            std::min((screen.high - screen.low) * length_of(&DoubleVec3::y), static_cast<double>(kMaxCoordinate)));
    } else {
        set_perspective(parameters, screen, size, camera, sink);
    }
    if (type != "perspective" && type != "orthographic") {
        constexpr std::array<std::string_view, 2> kKnown = {"perspective", "orthographic"};
        const bool is_known = type == "realistic" || type == "spherical" || type == "environment";
        sink.leave_out(
            {parameters.location(), fmt::format("cameras of the type {} are left out; a perspective one is used{}",
                                                shortened(type), is_known ? "" : did_you_mean(type, kKnown))});
        parameters.ignore({"lensfile", "aperturediameter", "focusdistance", "aperture", "simpleweighting", "mapping"});
    }
    const auto radius = static_cast<float>(parameters.number("lensradius", 0, sink) * length_of(&DoubleVec3::x));
    const auto focus = static_cast<float>(parameters.number("focaldistance", 1e6, sink) * length_of(&DoubleVec3::z));
    if (radius > 0 && focus > 0) {
        camera.aperture_radius = min(radius, kMaxCoordinate);
        camera.focus_distance = min(focus, kMaxCoordinate);
    }
    parameters.ignore({"shutteropen", "shutterclose"});
    parameters.leave_out_unknown(sink);
    if (const std::string fault = fault_of(camera); !fault.empty()) {
        sink.leave_out({parameters.location(), fmt::format("the camera is left out, because {}", fault)});
        return std::nullopt;
    }
    return camera;
}

} // namespace

void leave_out_unknown_type(const ViewStatement& stated, std::string_view what, std::span<const std::string_view> known,
                            Sink& sink) {
    if (std::ranges::find(known, stated.type) != known.end()) return;
    sink.leave_out(
        {stated.parameters.location(), fmt::format("the {} {} is unknown and left out{}", what, shortened(stated.type),
                                                   did_you_mean(stated.type, known))});
}

bool is_left_handed(const View& view) { return view.camera && determinant(view.camera_from_world) > 0; }

DoubleTransform scene_from_world(const View& view) {
    return is_left_handed(view) ? scale_by({-1, 1, 1}) : DoubleTransform();
}

void add_view(View& view, const Context& context, Scene& scene) {
    const FilmSize size = read_film(view, context, scene);
    suggest_settings(view, context, scene);
    if (!view.camera) return;
    if (const auto camera = make_camera(view, size, scene.origin_in_file, context)) scene.cameras.push_back(*camera);
}

} // namespace pertev::pbrt
