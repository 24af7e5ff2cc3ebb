#include "session/pictures/prepare_render.h"

#include <algorithm>
#include <iterator>

#include <fmt/format.h>

#include "accel/builders/bvh_cache.h"
#include "base/error.h"
#include "base/message_text.h"
#include "base/stopwatch.h"
#include "device_scene/crossed_surfaces.h"
#include "device_scene/pack_texels.h"
#include "formats/read_camera_path.h"
#include "session/check_integrator.h"
#include "session/devices/device_names.h"
#include "session/devices/machine.h"
#include "session/opening/calibrated_camera.h"
#include "session/opening/camera_list.h"
#include "session/opening/choose_camera.h"
#include "session/opening/movable_instances.h"
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
    const bool has_camera =
        camera.places_camera() || !camera.camera.empty() || !options.camera_path.empty() || options.camera_list;
    const bool is_off = options.scene.ground == "off" || has_camera || options.render.transparent ||
                        !finds_all_light(options.render.integrator);
    return is_off ? Ground::Off : Ground::Auto;
}

/// Refuses a picture for which there is no room before its scene is solved.
void check_film(const PictureOptions& options, const RenderSettings& settings, const Queue& queue) {
    const std::size_t film = predicted_film_bytes(settings);
    check_render_memory(film, settings, memory_to_render_in(queue, settings, max_memory_bytes(options.radiosity)));
}

/// Returns the picture's settings, after `options` have taken what the scene's file suggests.
RenderSettings take_settings(const RenderSetup& ready, PictureOptions& options, uint32_t verbs, const Scene& scene,
                             Sink& sink) {
    apply_suggestions(scene, scene_camera(options.scene.camera.camera, scene), verbs, options, sink);
    if (options.strict) refuse_what_is_left_out(sink.messages(), "nothing was rendered");
    RenderSettings settings = render_settings(options, scene);
    settings.tracers = ready.settings.tracers;
    if ((verbs & kRender) != 0 && options.keeps_history()) settings.history = options.reconstruction.settings.history;
    return settings;
}

/// Returns the camera of the options in a scene at rest.
MovingCamera camera_of(PictureOptions& options, uint32_t verbs, const std::optional<CameraPath>& path,
                       const RenderSettings& settings, const Scene& rest, Sink& sink) {
    fit_intrinsics({settings.width, settings.height}, options.scene.camera);
    MovingCamera camera(options.scene.camera, path, rest, aspect_of(settings.width, settings.height), sink);
    const Camera at_rest = camera.at(rest, std::nullopt);
    check_camera(settings, at_rest);
    check_panorama(settings, at_rest);
    if (options.real_time || (verbs & (kView | kBenchSequence)) != 0) check_reconstruction(at_rest);
    return camera;
}

/// Returns the options of one camera of the list, with the size that the scene's file suggests for it.
PictureOptions options_of_listed(const PictureOptions& options, uint32_t number, uint32_t verbs, const Scene& rest) {
    PictureOptions own = options_of_camera(options, number, verbs);
    const auto size = own.given.find("size");
    if (size == own.given.end() || size->second != SettingOrigin::Scene) return own;
    own.given.erase(size);
    own.size.reset();
    apply_suggestions(rest, scene_camera(own.scene.camera.camera, rest), verbs, own, nobody());
    return own;
}

/// Chooses the camera of a scene at rest, or those of a list, whose first gives `settings` its size.
void set_camera(PictureOptions& options, uint32_t verbs, const std::optional<CameraPath>& path, const Scene& rest,
                RenderSettings& settings, RenderSetup& ready) {
    Messages messages;
    std::vector<ListedCamera> list;
    for (uint32_t i = 0; options.camera_list && i < options.camera_list->size(); ++i) {
        PictureOptions own = options_of_listed(options, i, verbs, rest);
        set_size(own, rest, settings);
        Messages of_others; // duplicates, dropped
        MovingCamera camera = camera_of(own, verbs, path, settings, rest, i == 0 ? messages : of_others);
        list.push_back({std::move(camera), {settings.width, settings.height}});
    }
    if (list.empty()) {
        ready.camera.emplace(camera_of(options, verbs, path, settings, rest, messages));
    } else {
        ready.camera = list.front().camera;
        settings.width = list.front().size.width, settings.height = list.front().size.height;
    }
    ready.list = std::move(list);
    ready.of_camera = std::move(messages);
}

/// Returns the settings of the largest picture.
RenderSettings settings_of_largest(const RenderSetup& ready) {
    RenderSettings settings = ready.settings;
    const auto pixels = [](const ListedCamera& listed) { return uint64_t{listed.size.width} * listed.size.height; };
    const auto largest = std::ranges::max_element(ready.list, {}, pixels);
    if (largest != ready.list.end()) settings.width = largest->size.width, settings.height = largest->size.height;
    return settings;
}

void set_light(const RenderSettings& settings, const Scene& rest, RenderSetup& ready) {
    Messages messages;
    check_light(settings, rest, messages);
    ready.of_light = std::move(messages);
}

/// Warns if lights cannot be selected by the tree that the options name.
void report_light_choice(const PictureOptions& options, const RenderSettings& settings, const PreparedScene& prepared,
                         Sink& sink) {
    if (settings.path.light_choice != LightSelection::Tree) return;
    const bool of_frames = options.real_time || settings.is_denoised();
    const bool has_media_code = has_media(*prepared.scene) || !find_thin_walls(prepared).empty();
    const bool has_code = !has_media_code || has_tree_in_media(settings, of_frames);
    const char* const why = prepared.motions != nullptr ? "the tree holds lights at rest"
                            : !has_code                 ? "frames and layers of media and thin walls have no tree"
                            : settings.irradiance       ? "a light meter samples lights by power"
                            : prepared.lights.tree->light_count() == 0 ? "no light has a position"
                                                                       : nullptr;
    if (why == nullptr) return;
    sink.warn({"light_choice", "tree", fmt::format("lights are selected by power, because {}", why)});
}

/// Returns whether the choice leaves nothing open that is decided in the scene at rest.
bool is_whole(const PictureOptions& options, const Scene& scene) {
    const CameraChoice& choice = options.scene.camera;
    const bool is_own =
        !choice.places_camera() && scene_camera(choice.camera, scene) != nullptr && options.turntable == 0;
    const bool is_placed = !choice.pose.empty() || (choice.eye ? choice.target.has_value() : is_own);
    return is_placed && !choice.projection && (!choice.aperture || choice.focus);
}

/// Opens the options' scene, with the ground that they request, and records its files.
Scene read_scene(const PictureOptions& options, const SceneInMemory& in_memory, Sink& sink, RenderSetup& ready) {
    const bool shows_solution = is_solved(options.render.integrator) && !options.radiosity.solution.empty();
    const SceneUse use = shows_solution ? SceneUse::Measurement : SceneUse::Picture; // opened as for the solution
    ready.ground = ground_of(options);
    const std::size_t known = sink.messages().all().size();
    Scene scene = open_scene(options.scene, sink, use, ready.ground, in_memory.read);
    if (in_memory.edit) in_memory.edit(scene);
    ready.reading = sink.messages().since(known);
    // Files may change from here on.
    if (!in_memory.read) ready.hash = scene_hash(options.scene.scene);
    ready.files = files_of_scene(options, scene.files);
    return scene;
}

/// Returns what the trees and surfaces of the scene are built for.
PrepareOptions options_to_build(const PictureOptions& options, const RenderSettings& settings, const Scene& scene,
                                StartingMachine& machine) {
    // If it turns out not to be a GPU, the session makes what is missing.
    PrepareOptions prepare = prepare_options(settings, machine.may_be_cuda());
    prepare.may_be_better = may_be_better(options.tracer);
    prepare.apart = movable_instances(options.scene.movable, scene);
    if (!options.no_cache) prepare.bvh_cache = bvh_cache_folder();
    return prepare;
}

/// Solves the prepared scene by radiosity, or takes the solution that the options name.
void solve(const PictureOptions& options, Sink& sink, const SolveReport& report, RenderSetup& ready) {
    if (ready.moving->is_animated() && !options.frames.empty()) {
        throw Error(ErrorCode::BadInput, "frames", "",
                    "radiosity is solved for one time, and this scene moves; set `time` (`camera_path` and "
                    "`turntable` work with the scene at rest)");
    }
    RenderSettings& settings = ready.settings;
    sink.report_messages();
    check_film(options, settings, *ready.queue);
    settings.radiosity = radiosity_display(ready.prepared(), options.radiosity, settings.path.seed, sink, report);
}

} // namespace

std::string RenderSetup::device_name() const {
    std::vector<std::string> names;
    for (const auto& of_device : queues) names.push_back(of_device->device_name());
    return text_of_devices(names);
}

bool adapt_setup(RenderSetup& ready, const PictureOptions& before, PictureOptions& options, uint32_t verbs,
                 Sink& sink) {
    const Ground ground = ground_of(options);
    const bool has_same_ground = ground == ready.ground || (ground == Ground::Off && !has_ground(ready.scene()));
    if (options.scene.scene != before.scene.scene || !has_same_ground || !options.cameras.empty()) return false;
    bool has_same_camera = !ready.must_choose && options.scene.camera.camera_from.empty();
    for (const Setting& setting : all_settings()) {
        const bool is_given = before.is_given(setting.name) || options.is_given(setting.name);
        const bool is_of_picture = setting.changes == Changes::Picture || setting.changes == Changes::Display;
        if (!is_given || is_of_picture) continue;
        if (texts_of(before, setting) == texts_of(options, setting)) continue;
        if (setting.changes == Changes::Scene) return false;
        has_same_camera = false;
    }
    complete_options(options, verbs);
    if (options.strict) refuse_what_is_left_out(sink.messages(), "nothing was rendered");
    PictureOptions taken = options;
    apply_camera_from(taken);
    Messages messages;
    MovingScene& moving = *ready.moving;
    RenderSettings settings = take_settings(ready, taken, verbs, moving.scene(), messages);
    if (is_solved(ready.settings.integrator) || is_solved(settings.integrator)) return false;
    const bool has_same_size = settings.width == ready.settings.width && settings.height == ready.settings.height;
    const bool has_same_shape =
        aspect_of(settings.width, settings.height) == aspect_of(ready.settings.width, ready.settings.height);
    has_same_camera = has_same_camera && (taken.scene.camera.intrinsics.empty() ? has_same_shape : has_same_size);
    const bool has_frames = frame_range(options).has_value();
    const bool is_timed = moving.is_animated() && (moving.time_s() || moving.is_behind());
    if (!has_same_camera && !options.camera_path.empty()) return false;
    if (is_timed && !has_frames && !options.time_s) return false; // back at rest
    // Whatever is judged in the scene at rest stays.
    const bool is_decided = has_same_camera || is_whole(options, moving.scene());
    if (is_timed && (!is_decided || settings.integrator != ready.settings.integrator)) return false;
    const std::size_t bytes = bytes_to_render(taken, ready.prepared(), settings, *ready.queue);
    ready.must_choose = true; // until nothing can throw
    if (!is_timed) set_light(settings, moving.scene(), ready);
    if (has_same_camera) {
        check_camera(settings, ready.camera->at(moving.scene(), moving.time_s()));
    } else {
        set_camera(taken, verbs, std::nullopt, moving.scene(), settings, ready);
    }
    if (!has_frames) {
        const bool moves = options.time_s && (options.time_s != moving.time_s() || moving.is_behind());
        if (moves) ready.changed_parts |= moving.set_time(*options.time_s, messages);
        ready.sequence.time_s = options.time_s;
    }
    ready.must_choose = false;
    ready.settings = std::move(settings);
    ready.bytes = bytes;
    report_light_choice(taken, ready.settings, ready.prepared(), messages);
    options = std::move(taken);
    messages.add_all(ready.of_light);
    messages.add_all(ready.of_camera);
    sink.add_all(messages);
    return true;
}

std::unique_ptr<RenderSetup> prepare_render(PictureOptions& options, uint32_t verbs, Sink& sink,
                                            const SolveReport& report, const SceneInMemory& in_memory) {
    complete_options(options, verbs);
    read_camera_list(options);
    apply_camera_from(options);
    std::optional<CameraPath> path;
    if (!options.camera_path.empty()) path = read_camera_path(options.camera_path);
    StartingMachine machine(options.machine, sink, StartingMachine::Takes::AllNamed);
    const UseThreads threads(machine.threads());
    auto ready = std::make_unique<RenderSetup>();
    RenderSettings& settings = ready->settings;
    // A tracer that does not fit the device is refused before the scene is read.
    if (!options.tracer.are_empty()) settings.tracers = tracer_choice(options.tracer, machine.is_cuda());
    sink.report_messages();
    sink.set_work(fmt::format("loading {}", options.scene.scene));
    const Stopwatch watch;
    Scene scene = read_scene(options, in_memory, sink, *ready);
    settings = take_settings(*ready, options, verbs, scene, sink);
    set_light(settings, scene, *ready);
    set_camera(options, verbs, path, scene, settings, *ready);
    sink.add_all(ready->of_light);
    sink.add_all(ready->of_camera);
    ready->load_s = watch.seconds();
    const PrepareOptions prepare = options_to_build(options, settings, scene, machine);
    sink.set_work("building trees");
    ready->sequence = frame_range(options).value_or(FrameRange{.time_s = options.time_s, .shutter = shutter(options)});
    ready->moving.emplace(std::move(scene), ready->sequence.time_of(ready->sequence.first), prepare, sink,
                          ready->sequence.shutter);
    sink.check();
    for (auto& queue : machine.take_all()) ready->queues.push_back(std::move(queue));
    ready->queue = ready->queues.front();
    if (is_solved(settings.integrator)) solve(options, sink, report, *ready);
    ready->bytes = bytes_to_render(options, ready->prepared(), settings_of_largest(*ready), *ready->queue);
    report_light_choice(options, settings, ready->prepared(), sink);
    return ready;
}

void record_settings(const PictureOptions& options, const Scene& scene, uint32_t frame, PictureRecord& record) {
    if (options.camera_list)
        return record_settings(options_of_listed(options, frame, kRender, scene), scene, frame, record);
    SceneSource& source = record.scene;
    const CameraChoice& choice = options.scene.camera;
    const Camera* const own = scene_camera(choice.camera, scene);
    const bool is_own = own != nullptr && !choice.places_camera() && options.camera_path.empty();
    auto origins = options.given; // the scene's own camera has no value that a settings file could contain
    if (const auto range = origins.extract("samples")) origins.try_emplace("spp", range.mapped());
    // The picture is that of all parts, with or without a checkpoint.
    for (const Setting& setting : all_settings()) {
        if (setting.group == SettingGroup::Parts) origins.erase(setting.name);
    }
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
    if (!is_own && !choice.places_camera() && options.camera_path.empty()) add(source.by_default, "camera");
    const bool has_own_sky = !options.scene.environment.empty() || !options.scene.sun_sky.empty();
    if (source.has_environment && !has_own_sky) add(source.by_default, "environment");
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
    const MemoryLimit limit = memory_to_render_in(queue, settings, max_memory_bytes(options.radiosity));
    // Textures are packed to count them, so only the message of an error has their number.
    check_render_memory(bytes, settings, limit, bytes > limit.bytes ? texture_bytes(*prepared.scene) : 0);
    return bytes;
}

void report_motion(const PictureOptions& options, const MovingScene& moving, Sink& sink) {
    const bool has_time = options.time_s || !options.frames.empty();
    if (moving.is_animated() && !has_time) {
        sink.note({FileLocation{options.scene.scene},
                   fmt::format("the scene is shown at rest; `time` shows it at a time of its {} (0 to {:.4g} s)",
                               counted(moving.scene().animations.size(), "animation"), moving.end_s())});
    }
    if (std::ranges::count(options.aovs, "motion") > 0 && options.frames.empty() && options.turntable == 0) {
        sink.note({"aov", "motion", "there is no motion without `frames`, because there is no earlier frame"});
    }
    const bool camera_moves = !options.camera_path.empty() || options.turntable > 0;
    if (!moving.is_animated() && has_time && !camera_moves && !options.real_time) { // records gather light at rest
        sink.warn({options.time_s ? "time" : "frames", "",
                   "nothing moves in this scene (`time_limit` ends a render after a time)"});
    }
}

PictureRecord picture_record(const PictureOptions& options, RenderSetup& ready, const Messages& messages) {
    PictureRecord record = {.scene = source_of(options.scene, ready.scene()),
                            .camera = {},
                            .settings = ready.settings,
                            .device = ready.device_name(),
                            .frame = {},
                            .display = {},
                            .numbers = number_formats(options)};
    record.scene.hash = ready.hash;
    std::vector<FileOfPicture>& files = record.scene.files = ready.files;
    std::ranges::copy(files_of_settings(options), std::back_inserter(files));
    give_own_names(files);
    if ((ready.settings.aovs & kAovIds) != 0) name_ids(ready.scene(), record.scene);
    record.scene.made_up = messages.made_up();
    record.scene.left_out = messages.left_out();
    record.scene.load_seconds = ready.load_s;
    record.scene.build_seconds = ready.prepared().build_seconds;
    const uint32_t first = ready.sequence.first;
    if (options.real_time)
        record.frame = ReconstructedFrame{options.reconstruction.used(), options.reconstruction.sharing};
    if (options.real_time || options.keeps_history()) record.in_sequence = FrameInSequence{first, first};
    place_frame(first, *ready.moving, {*ready.camera, ready.sequence, ready.list}, record);
    record_settings(options, ready.scene(), first, record);
    return record;
}

} // namespace pertev
