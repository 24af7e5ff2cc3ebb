// pertev render SCENE -o OUT

#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <optional>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "apps/cli/choose_device.h"
#include "apps/cli/commands.h"
#include "apps/cli/interrupt.h"
#include "apps/cli/parse_values.h"
#include "apps/cli/reporter.h"
#include "apps/cli/scene_options.h"
#include "base/error.h"
#include "base/limits.h"
#include "base/parallel_for.h"
#include "base/version.h"
#include "base/write_file_atomically.h"
#include "image/auto_exposure.h"
#include "image/picture_hash.h"
#include "image/tone_map_image.h"
#include "image/write_image.h"
#include "integrators/render_picture.h"
#include "accel/bvh/bvh_cache.h"

namespace pertev {
namespace {

struct RenderFlags {
    SceneOptions scene;
    std::vector<std::string> outputs;
    std::string size;
    uint32_t samples = 64;
    double time_s = 0;
    std::string integrator = "path", sampler = "sobol", filter = "blackman-harris", device = "auto", tone_map = "srgb", exposure;
    float filter_radius = 0, clamp = 0;
    uint32_t max_depth = 16, seed = 0;
    int threads = 0;
    std::vector<std::string> aovs;
    bool transparent = false, no_cache = false, quiet = false, json = false, strict = false;
};

template <class T>
T choice(const std::vector<std::pair<std::string, T>>& names, const std::string& name) {
    return std::ranges::find(names, name, &std::pair<std::string, T>::first)->second; // CLI11 has checked it
}

const std::vector<std::pair<std::string, PathLight>> kIntegrators = {
    {"path", PathLight::Path}, {"direct", PathLight::Direct}, {"indirect", PathLight::Indirect}};
const std::vector<std::pair<std::string, SamplerKind>> kSamplers = {{"sobol", SamplerKind::Sobol},
                                                                    {"independent", SamplerKind::Independent}};
const std::vector<std::pair<std::string, PixelFilter>> kFilters = {{"box", PixelFilter::Box},
                                                                   {"tent", PixelFilter::Tent},
                                                                   {"gaussian", PixelFilter::Gaussian},
                                                                   {"blackman-harris", PixelFilter::BlackmanHarris}};
const std::vector<std::pair<std::string, uint32_t>> kAovs = {{"albedo", kAovAlbedo}, {"normal", kAovNormal},
                                                             {"depth", kAovDepth},   {"position", kAovPosition},
                                                             {"ids", kAovIds}};

template <class T>
std::vector<std::string> names_of(const std::vector<std::pair<std::string, T>>& choices) {
    std::vector<std::string> names;
    for (const auto& [name, value] : choices) names.push_back(name);
    return names;
}

RenderSettings settings_of(const RenderFlags& flags, const Scene& scene) {
    RenderSettings settings;
    if (!flags.size.empty()) {
        std::tie(settings.width, settings.height) = parse_size("--size", flags.size);
    } else if (!scene.cameras.empty() && scene.cameras.front().aspect > 0 && flags.scene.camera.empty()) {
        settings.height = 720; // the file's camera says the shape
        settings.width = static_cast<uint32_t>(to_int(720 * scene.cameras.front().aspect + 0.5f, 1, 8192));
    }
    settings.samples = flags.samples;
    settings.filter = choice(kFilters, flags.filter);
    settings.filter_radius = flags.filter_radius;
    settings.transparent = flags.transparent;
    settings.time_limit_s = flags.time_s;
    for (const std::string& name : flags.aovs) settings.aovs |= choice(kAovs, name);
    settings.path = {.max_depth = flags.max_depth,
                     .light = choice(kIntegrators, flags.integrator),
                     .clamp = flags.clamp,
                     .sampler = choice(kSamplers, flags.sampler),
                     .seed = flags.seed,
                     .camera_axis = {}};
    return settings;
}

double peak_memory_mib() {
    rusage usage{};
    ::getrusage(RUSAGE_SELF, &usage);
    return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

ExrMetadata metadata_of(const RenderFlags& flags, const RenderSettings& settings, const RenderResult& result,
                        const std::string& device, const std::string& hash, double load_s, double build_s) {
    return {{"pertev.version", fmt::format("{} {}", version(), git_commit())},
            {"pertev.scene", flags.scene.scene},
            {"pertev.samples", static_cast<int32_t>(result.samples)},
            {"pertev.max_depth", static_cast<int32_t>(settings.path.max_depth)},
            {"pertev.integrator", flags.integrator},
            {"pertev.sampler", flags.sampler},
            {"pertev.filter", flags.filter},
            {"pertev.seed", fmt::format("{}", flags.seed)},
            {"pertev.clamp", flags.clamp},
            {"pertev.device", device},
            {"pertev.hash", hash},
            {"pertev.invalid_samples", static_cast<double>(result.invalid_samples)},
            {"pertev.load_seconds", load_s},
            {"pertev.build_seconds", build_s},
            {"pertev.render_seconds", result.render_seconds},
            {"pertev.rays", static_cast<double>(result.rays.total())}};
}

std::vector<ExrLayer> layers_of(RenderResult& result) {
    std::vector<ExrLayer> layers;
    for (FilmLayer& layer : result.layers) {
        layers.push_back({layer.name, layer.channels, std::move(layer.image.pixels)});
    }
    if (!result.ids.empty()) {
        std::vector<uint32_t> ids;
        for (const PixelIds& id : result.ids) ids.insert(ids.end(), {id.instance, id.primitive, id.material});
        layers.push_back({"id", {"instance", "primitive", "material"}, std::move(ids)});
    }
    return layers;
}

std::string progress_detail(const RenderProgress& now) {
    const double share = static_cast<double>(now.samples_done) / now.samples;
    const double left = now.seconds * (1 - share) / std::max(share, 1e-9);
    return fmt::format("{}/{} spp  {:.1f} Mrays/s  {:.0f} s left", now.samples_done, now.samples,
                       static_cast<double>(now.rays.total()) / now.seconds * 1e-6, left);
}

bool wants_auto_exposure(const RenderFlags& flags, bool default_light) {
    return flags.exposure == "auto" || (flags.exposure.empty() && default_light);
}

/// Stops for PNG and JPEG.
float exposure_of(const RenderFlags& flags, bool default_light, const Image& picture, Reporter& reporter) {
    if (!wants_auto_exposure(flags, default_light)) {
        return flags.exposure.empty() ? 0.0f : parse_number("--exposure", flags.exposure);
    }
    const float stops = auto_exposure_stops(picture);
    const bool shows = std::ranges::any_of(flags.outputs, [](const std::string& output) {
        const ImageFormat format = image_format_for(output);
        return format == ImageFormat::Png || format == ImageFormat::Jpeg;
    });
    if (shows) reporter.say(fmt::format("note: exposed by {:+.2f} stops (--exposure {:.2f})", stops, stops));
    return stops;
}

void check_flags(const RenderFlags& flags) {
    if (!flags.exposure.empty() && flags.exposure != "auto") parse_number("--exposure", flags.exposure);
    bool any_exr = false;
    for (const std::string& output : flags.outputs) {
        any_exr = image_format_for(output) == ImageFormat::Exr || any_exr;
        check_writable(output);
    }
    if (!flags.aovs.empty() && !any_exr) {
        throw Error(ErrorCode::BadInput, "--aov: layers are kept in EXR files alone; add -o NAME.exr");
    }
}

int render(const RenderFlags& flags) {
    check_flags(flags);
    if (flags.threads > 0) set_thread_count(flags.threads);
    Reporter reporter(flags.quiet, flags.json);
    Messages messages;
    const std::unique_ptr<Queue> queue = choose_device(flags.device, messages);

    const auto start = std::chrono::steady_clock::now();
    const auto seconds = [&] {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    };
    const LoadedScene loaded = load_scene(flags.scene, messages);
    const Scene& scene = loaded.scene;
    const RenderSettings settings = settings_of(flags, scene);
    const Camera camera = choose_camera(flags.scene, scene, settings.width, settings.height, messages);
    const double load_s = seconds();
    PrepareOptions prepare;
    if (!flags.no_cache) prepare.bvh_cache = bvh_cache_folder();
    const PreparedScene prepared = prepare_scene(scene, prepare, messages);
    reporter.say(messages);
    reporter.say(fmt::format("{}: {} triangles, {} instances, {} lights; loaded in {:.2f} s, trees in {:.2f} s; "
                             "rendering {}x{}, {} spp on {}, {:.0f} MiB there",
                             flags.scene.scene, prepared.triangles, scene.instances.size(),
                             prepared.lights.choice.count, load_s, prepared.build_seconds, settings.width, settings.height, settings.samples,
                             queue->device_name(),
                             static_cast<double>(predicted_bytes(prepared, settings, queue->is_cuda())) / 1048576.0));

    listen_for_interrupt();
    RenderResult result = render_picture(*queue, prepared, camera, settings, [&](const RenderProgress& now) {
        reporter.progress(static_cast<double>(now.samples_done) / now.samples, progress_detail(now));
        reporter.event(fmt::format(R"({{"event":"progress","samples":{},"of":{},"seconds":{:.3f},"rays":{}}})",
                                   now.samples_done, now.samples, now.seconds, now.rays.total()));
        return !interrupted();
    });
    reporter.end_progress();

    const std::string hash = picture_hash(result.picture).hex();
    WriteImageOptions write;
    write.tone_map = *tone_map_named(flags.tone_map);
    write.exposure_stops = exposure_of(flags, loaded.default_light, result.picture, reporter);
    write.transparent = flags.transparent;
    const std::vector<ExrLayer> layers = layers_of(result);
    write.layers = layers;
    write.metadata = metadata_of(flags, settings, result, queue->device_name(), hash, load_s, prepared.build_seconds);
    for (const std::string& output : flags.outputs) write_image(output, result.picture, write);

    const double samples = static_cast<double>(settings.width) * settings.height * result.samples;
    const double mrays = static_cast<double>(result.rays.total()) / result.render_seconds * 1e-6;
    reporter.say(fmt::format("{} spp in {:.2f} s ({:.2f} s in all), {:.2f} Msamples/s, {:.1f} Mrays/s, peak {:.0f} MiB "
                             "here and {:.0f} MiB there, {} invalid samples, picture {}",
                             result.samples, result.render_seconds, seconds(), samples / result.render_seconds * 1e-6,
                             mrays, peak_memory_mib(), static_cast<double>(result.device_peak_bytes) / 1048576.0,
                             result.invalid_samples, hash));
    reporter.event(fmt::format(
        R"({{"event":"done","samples":{},"seconds":{:.4f},"total_seconds":{:.4f},"samples_per_second":{:.0f},"rays_per_second":{:.0f},"peak_bytes":{:.0f},"device_peak_bytes":{},"invalid_samples":{},"hash":"{}","device":{}}})",
        result.samples, result.render_seconds, seconds(), samples / result.render_seconds, mrays * 1e6,
        peak_memory_mib() * 1048576.0, result.device_peak_bytes, result.invalid_samples, hash,
        json_string(queue->device_name())));
    if (flags.strict && result.invalid_samples > 0) {
        throw Error(ErrorCode::BadInput,
                    fmt::format("--strict: {} samples were not finite; the picture is written", result.invalid_samples));
    }
    return interrupted() && result.samples < settings.samples ? exit_status(ErrorCode::Interrupted) : 0;
}

} // namespace

void add_render_command(CLI::App& app, int& status) {
    CLI::App& verb = *app.add_subcommand("render", "Render a picture of a scene");
    const auto flags = std::make_shared<RenderFlags>();
    add_scene_options(verb, flags->scene);
    verb.add_option("-o,--output", flags->outputs, "picture to write: .exr .png .jpg .hdr; may be given again")
        ->required();
    const char* group = "Picture";
    verb.add_option("--size", flags->size, "WIDTHxHEIGHT (1280x720, or the shape that the scene's camera asks for)")
        ->group(group);
    verb.add_option("--tone-map", flags->tone_map, "of PNG and JPEG: srgb, agx, aces or neutral")
        ->check(CLI::IsMember({"srgb", "agx", "aces", "neutral"}))->capture_default_str()->group(group);
    verb.add_option("--exposure", flags->exposure,
                    "of PNG and JPEG: stops, or auto (0; auto where the light was made up for lack of any)")
        ->group(group);
    verb.add_flag("--transparent", flags->transparent, "keep how much of a pixel is covered as alpha")->group(group);
    verb.add_option("--aov", flags->aovs, "layers of an EXR: albedo normal depth position ids")
        ->delimiter(',')->check(CLI::IsMember(names_of(kAovs)))->group(group);
    group = "Quality";
    verb.add_option("--spp", flags->samples, "samples a pixel")
        ->check(CLI::Range(1u, kMaxSamplesPerPixel))->capture_default_str()->group(group);
    verb.add_option("--time", flags->time_s, "stop after this many seconds, at a whole sample")
        ->check(CLI::PositiveNumber)->group(group);
    verb.add_option("--integrator", flags->integrator, "path, or its parts direct and indirect")
        ->check(CLI::IsMember(names_of(kIntegrators)))->capture_default_str()->group(group);
    verb.add_option("--max-depth", flags->max_depth, "most scatterings of a path: 0 emission, 1 direct light")
        ->check(CLI::Range(0u, kMaxPathDepth - 1))->capture_default_str()->group(group);
    verb.add_option("--seed", flags->seed, "of the random numbers")->capture_default_str()->group(group);
    verb.add_option("--sampler", flags->sampler, "sobol or independent")
        ->check(CLI::IsMember(names_of(kSamplers)))->capture_default_str()->group(group);
    verb.add_option("--filter", flags->filter, "of pixels: box, tent, gaussian or blackman-harris")
        ->check(CLI::IsMember(names_of(kFilters)))->capture_default_str()->group(group);
    verb.add_option("--filter-radius", flags->filter_radius, "pixels (the filter's own)")
        ->check(CLI::PositiveNumber)->group(group);
    verb.add_option("--clamp", flags->clamp, "largest contribution after the first scattering; biased, off by default")
        ->check(CLI::PositiveNumber)->group(group);
    group = "Machine";
    verb.add_option("--device", flags->device, "auto, cpu, cuda or cuda:N")->capture_default_str()->group(group);
    verb.add_option("--threads", flags->threads, "of the CPU (all)")->check(CLI::Range(1, 4096))->group(group);
    verb.add_flag("--no-bvh-cache", flags->no_cache, "build the tree even if it was built before")->group(group);
    verb.add_flag("-q,--quiet", flags->quiet, "say nothing but errors");
    verb.add_flag("--json", flags->json, "progress and result as JSON lines on stdout");
    verb.add_flag("--strict", flags->strict, "fail when a sample is not finite");
    verb.callback([flags, &status] { status = render(*flags); });
}

} // namespace pertev
