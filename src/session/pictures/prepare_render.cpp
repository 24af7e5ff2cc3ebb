#include "session/pictures/prepare_render.h"

#include <algorithm>
#include <span>

#include <fmt/format.h>

#include "accel/builders/bvh_cache.h"
#include "base/error.h"
#include "base/message_text.h"
#include "base/stopwatch.h"
#include "formats/read_camera_path.h"
#include "session/check_integrator.h"
#include "session/machine.h"
#include "session/opening/open_scene.h"
#include "session/opening/picture_settings.h"
#include "session/opening/strictness.h"
#include "session/pictures/check_options.h"
#include "session/pictures/frame_settings.h"
#include "session/render_memory.h"
#include "session/session_bytes.h"
#include "session/survey/ground.h"
#include "settings/check_settings.h"
#include "settings/settings_file.h"
#include "settings/tracer_options.h"

namespace pertev {
namespace {

/// Returns Auto if the view is a default one too and shows a background. An alpha channel removes the ground, and
/// integrators with only a part of the light would show a ground that differs from the studio's floor.
Ground ground_of(const PictureOptions& options) {
    if (options.scene.ground == "on") return Ground::On;
    const CameraChoice& camera = options.scene.camera;
    const bool has_camera = camera.eye || !camera.camera.empty() || !options.camera_path.empty();
    const bool is_off = options.scene.ground == "off" || has_camera || options.render.transparent ||
                        !finds_all_light(options.render.integrator);
    return is_off ? Ground::Off : Ground::Auto;
}

/// Refuses a picture for which there is no room before its scene is solved.
void check_film(const PictureOptions& options, const RenderSettings& settings, const Queue& queue) {
    const std::size_t film = Film::predicted_bytes(settings.width, settings.height, settings.aovs,
                                                   light_layers_of(settings), settings.layers_at);
    check_render_memory(film, settings, memory_to_render_in(queue, settings, max_memory_bytes(options.radiosity)));
}

/// Returns the messages with these indices and above.
Messages messages_from(const Messages& messages, std::size_t first) {
    Messages found;
    for (const Message& message : std::span(messages.all()).subspan(first)) {
        if (message.is_left_out) {
            found.leave_out(message.remark);
        } else if (message.is_made_up) {
            found.make_up(message.remark);
        } else if (message.is_warning) {
            found.warn(message.remark);
        } else {
            found.note(message.remark);
        }
    }
    return found;
}

/// Sets the settings and the camera of a scene at rest, to whose file's suggestions `options` give way.
void set_picture(RenderSetup& ready, PictureOptions& options, uint32_t verbs, const std::optional<CameraPath>& path,
                 const Scene& scene, Messages& messages) {
    take_suggestions(scene, verbs, options, messages);
    if (options.strict) refuse_what_is_left_out(messages, "nothing is rendered");
    RenderSettings settings = render_settings(options, scene);
    settings.tracers = ready.settings.tracers;
    check_light(settings, scene, messages);
    MovingCamera camera(options.scene.camera, path, scene, aspect_of(settings.width, settings.height), messages);
    check_camera(settings, camera.at(scene, std::nullopt));
    ready.settings = std::move(settings);
    ready.camera.emplace(std::move(camera));
}

/// Settings that change neither the scene that is read, nor its trees, nor the machine. A setting that is missing here
/// costs time, and no picture.
constexpr std::string_view kOfPictures[] = {
    "camera", "eye",           "target",       "up",          "fov",     "projection", "view_height", "aperture",
    "focus",  "size",          "spp",          "seed",        "sampler", "filter",     "clamp",       "integrator",
    "aov",    "filter_radius", "max_depth",    "transparent", "denoise", "tone_map",   "lpe",         "exposure",
    "iso",    "f_number",      "shutter_time", "time_limit"};

} // namespace

bool adapt_setup(RenderSetup& ready, const PictureOptions& before, PictureOptions& options, uint32_t verbs,
                 Sink& sink) {
    const auto differs = [&](const Setting& setting) {
        return std::ranges::find(kOfPictures, setting.name) == std::end(kOfPictures) &&
               texts_of(before, setting) != texts_of(options, setting);
    };
    const Ground ground = ground_of(options);
    const bool has_same_ground = ground == ready.ground || (ground == Ground::Off && !has_ground(ready.scene()));
    const bool is_at_rest = !ready.moving->time_s() && !frame_range(options) && options.camera_path.empty();
    if (!is_at_rest || options.scene.scene != before.scene.scene || !has_same_ground ||
        is_solved(before.render.integrator) || is_solved(options.render.integrator) ||
        std::ranges::any_of(all_settings(), differs)) {
        return false;
    }
    check_options(options, verbs);
    set_picture(ready, options, verbs, std::nullopt, ready.scene(), sink.messages());
    ready.bytes = bytes_to_render(options, ready.prepared(), ready.settings, *ready.queue);
    return true;
}

std::unique_ptr<RenderSetup> prepare_render(PictureOptions& options, uint32_t verbs, Sink& sink,
                                            const SolveReport& report) {
    if (options.real_time && !options.is_given("spp")) options.render.samples = 1;
    check_options(options, verbs);
    Messages& messages = sink.messages();
    std::optional<CameraPath> path;
    if (!options.camera_path.empty()) path = read_camera_path(options.camera_path);
    ComingMachine machine(options.machine, messages);
    std::optional<TracerChoice> tracers; // a tracer that does not fit the device is refused before the scene is read
    if (!options.tracer.are_empty()) tracers = tracer_choice(options.tracer, machine.is_cuda());
    sink.report_messages();
    sink.set_work(fmt::format("loading {}", options.scene.scene));
    const Stopwatch watch;
    auto ready = std::make_unique<RenderSetup>();
    const bool shows_solution = is_solved(options.render.integrator) && !options.radiosity.solution.empty();
    const SceneUse use = shows_solution ? SceneUse::Measurement : SceneUse::Picture; // opened as for the solution
    ready->ground = ground_of(options);
    const std::size_t known = messages.all().size();
    Scene scene = open_scene(options.scene, messages, use, ready->ground);
    ready->reading = messages_from(messages, known);
    sink.check(); // the file was read to its end, and trees are built to theirs
    RenderSettings& settings = ready->settings;
    settings.tracers = tracers;
    set_picture(*ready, options, verbs, path, scene, messages);
    ready->load_s = watch.seconds();
    // If it turns out not to be a GPU, the session makes what is missing.
    PrepareOptions prepare = prepare_options(settings, machine.may_be_cuda());
    prepare.may_be_better = may_be_better(options.tracer);
    if (!options.no_cache) prepare.bvh_cache = bvh_cache_folder();
    sink.set_work("building trees");
    ready->sequence = frame_range(options).value_or(FrameRange{.time_s = options.time_s, .shutter = shutter(options)});
    ready->moving.emplace(std::move(scene), ready->sequence.time_of(ready->sequence.first), prepare, messages,
                          ready->sequence.shutter);
    sink.check();
    ready->queue = machine.take();
    if (is_solved(settings.integrator)) {
        if (ready->moving->is_animated() && !options.frames.empty()) {
            throw Error(ErrorCode::BadInput, "frames", "",
                        "radiosity is solved for one time, and this scene moves; set `time` (`camera_path` and "
                        "`turntable` work with the scene at rest)");
        }
        sink.report_messages();
        check_film(options, settings, *ready->queue);
        settings.radiosity = radiosity_display(ready->prepared(), options.radiosity, settings.path.seed, sink, report);
    }
    ready->bytes = bytes_to_render(options, ready->prepared(), settings, *ready->queue);
    return ready;
}

void record_settings(const PictureOptions& options, const Scene& scene, uint32_t frame, PictureRecord& record) {
    SceneSource& source = record.scene;
    const CameraChoice& choice = options.scene.camera;
    const Camera* const own = scene_camera(choice.camera, scene);
    const bool is_own = own != nullptr && !choice.eye && options.camera_path.empty();
    auto origins = options.given; // the scene's own camera has no value that a settings file could contain
    if (is_own) origins.try_emplace("camera", SettingOrigin::Scene);
    if (own != nullptr && own->aspect > 0) origins.try_emplace("size", SettingOrigin::Scene);
    source.by_default = source.by_scene = source.by_settings = source.by_caller = "";
    const auto add = [](std::string& names, const std::string& name) { names += (names.empty() ? "" : " ") + name; };
    for (const auto& [name, origin] : origins) {
        add(origin == SettingOrigin::Caller ? source.by_caller
            : origin == SettingOrigin::File ? source.by_settings
                                            : source.by_scene,
            name);
    }
    if (!is_own && !choice.eye && options.camera_path.empty()) add(source.by_default, "camera");
    if (source.has_environment && options.scene.environment.empty()) add(source.by_default, "environment");
    if (!source.ground.empty() && !options.is_given("ground")) add(source.by_default, "ground");
    if (source.hash.empty()) source.hash = scene_hash(options.scene.scene);
    source.settings = settings_of_frame(options, record, frame);
}

std::size_t bytes_to_render(const PictureOptions& options, const PreparedScene& prepared,
                            const RenderSettings& settings, const Queue& queue) {
    const ReconstructionOptions& frames = options.reconstruction;
    const std::size_t bytes =
        options.real_time ? predicted_frame_bytes(prepared, settings, frames.used(), frames.sharing, queue.is_cuda())
                          : predicted_bytes(prepared, settings, queue.is_cuda());
    check_render_memory(bytes, settings, memory_to_render_in(queue, settings, max_memory_bytes(options.radiosity)));
    return bytes;
}

void report_motion(const PictureOptions& options, const MovingScene& moving, Messages& messages) {
    const bool has_time = options.time_s || !options.frames.empty();
    if (moving.is_animated() && !has_time) {
        messages.note({FileLocation{options.scene.scene},
                       fmt::format("shown at rest; `time` shows it at a time of its {} (0 to {:.4g} s)",
                                   counted(moving.scene().animations.size(), "animation"), moving.end_s())});
    }
    if (std::ranges::count(options.aovs, "motion") > 0 && options.frames.empty()) {
        messages.note({"aov", "motion", "0 without `frames`, as there is no frame before"});
    }
    const bool camera_moves = !options.camera_path.empty() || options.turntable > 0;
    if (!moving.is_animated() && has_time && !camera_moves && !options.real_time) { // which gather light at rest
        messages.warn({options.time_s ? "time" : "frames", "",
                       "nothing moves in this scene (`time_limit` ends a render after a time)"});
    }
}

PictureRecord picture_record(const PictureOptions& options, RenderSetup& ready, const Messages& messages) {
    PictureRecord record = {.scene = source_of(options.scene, ready.scene()),
                            .camera = {},
                            .settings = ready.settings,
                            .device = ready.queue->device_name(),
                            .frame = {},
                            .display = {}};
    record.scene.hash = ready.hash;
    if ((ready.settings.aovs & kAovIds) != 0) name_ids(ready.scene(), record.scene);
    record.scene.made_up = messages.made_up();
    record.scene.left_out = messages.left_out();
    record.scene.load_seconds = ready.load_s;
    record.scene.build_seconds = ready.prepared().build_seconds;
    const uint32_t first = ready.sequence.first;
    if (options.real_time)
        record.frame = ReconstructedFrame{first, first, options.reconstruction.used(), options.reconstruction.sharing};
    place_frame(first, *ready.moving, {*ready.camera, ready.sequence}, record);
    record_settings(options, ready.scene(), first, record);
    return record;
}

} // namespace pertev
