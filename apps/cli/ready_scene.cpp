#include "apps/cli/ready_scene.h"

#include <algorithm>

#include <fmt/format.h>

#include "accel/builders/bvh_cache.h"
#include "apps/cli/flag_checks.h"
#include "apps/cli/render_frames.h"
#include "apps/cli/strictness.h"
#include "base/error.h"
#include "base/message_text.h"
#include "base/stopwatch.h"
#include "formats/read_camera_path.h"
#include "render/film.h"
#include "session/check_integrator.h"
#include "session/render_memory.h"
#include "settings/settings_file.h"

namespace pertev {
namespace {

/// Auto where the view is made up, too, and shows a background: an alpha channel leaves it out, and integrators that
/// find a part of the light alone show a ground that differs from the studio's floor.
Ground ground_of(const RenderFlags& flags) {
    refuse(
        flags.scene.ground == "on" && flags.render.transparent,
        "--ground on: the ground is a part of the background, which --transparent leaves out; leave out one of them");
    if (flags.scene.ground == "on") return Ground::On;
    const CameraChoice& camera = flags.scene.camera;
    const bool has_camera = camera.eye || !camera.camera.empty() || !flags.camera_path.empty();
    const bool is_off = flags.scene.ground == "off" || has_camera || flags.render.transparent ||
                        !finds_all_light(flags.render.integrator);
    return is_off ? Ground::Off : Ground::Auto;
}

/// Says all that was asked for, and what asked for it, with the size and the number of samples that came of it.
void tell_settings(PictureOptions options, const RenderSettings& settings, SceneSource& source) {
    for (const auto& [name, origin] : options.given) {
        std::string& names = origin == SettingOrigin::Flag ? source.by_flags : source.by_file;
        names += (names.empty() ? "" : " ") + name;
    }
    options.size = PictureSize{settings.width, settings.height};
    options.given.try_emplace("size", SettingOrigin::File);
    options.given.try_emplace("spp", SettingOrigin::File);
    source.hash = scene_hash(options.scene.scene);
    source.settings = settings_json(options, source.hash);
}

} // namespace

void say_what_moves(const RenderFlags& flags, const MovingScene& moving, Messages& messages) {
    const bool has_time = flags.time_s || !flags.frames.empty();
    if (moving.is_animated() && !has_time) {
        const double end_s = moving.end_s();
        messages.note(fmt::format("{}: shown at rest; --time S shows it at a time of its {} (0 to {:.4g} s)",
                                  flags.scene.scene, counted(moving.scene().animations.size(), "animation"), end_s));
    }
    if (std::ranges::count(flags.aovs, "motion") > 0 && flags.frames.empty()) {
        messages.note("--aov motion: 0 without --frames, whose frames have one before them");
    }
    const bool camera_moves = !flags.camera_path.empty() || flags.turntable > 0;
    if (!moving.is_animated() && has_time && !camera_moves && !flags.real_time) { // which gather light at rest
        messages.warn(fmt::format("--{}: nothing moves in this scene (--time-limit ends a render after a time)",
                                  flags.time_s ? "time" : "frames"));
    }
}

std::unique_ptr<ReadyScene> make_ready(const RenderFlags& flags, Reporter& reporter) {
    Messages& messages = reporter.messages();
    std::optional<CameraPath> path;
    if (!flags.camera_path.empty()) path = read_camera_path(flags.camera_path);
    ComingMachine machine(flags.machine, messages);
    std::optional<TracerChoice> tracers; // what does not fit the device is refused before the scene is read
    if (!flags.tracer.are_empty()) tracers = tracer_choice(flags.tracer, machine.is_cuda());
    reporter.say_messages();
    reporter.set_work(fmt::format("loading {}", flags.scene.scene));
    const Stopwatch watch;
    auto ready = std::make_unique<ReadyScene>();
    OpenOptions open = open_options(flags.scene);
    open.ground = ground_of(flags);
    Scene scene = open_scene(open, messages);
    if (flags.strict) refuse_what_is_left_out(messages, "nothing is rendered");
    RenderSettings& settings = ready->settings;
    settings = render_settings(flags, scene);
    settings.tracers = tracers;
    check_light(settings, scene, messages);
    ready->camera.emplace(flags.scene.camera, path, scene, aspect_of(settings.width, settings.height), messages);
    check_camera(settings, ready->camera->at(scene, std::nullopt));
    ready->load_s = watch.seconds();
    // Where it is none after all, the session makes what is missing.
    PrepareOptions prepare = prepare_options(settings, machine.may_be_cuda());
    prepare.may_be_better = may_be_better(flags.tracer);
    if (!flags.no_cache) prepare.bvh_cache = bvh_cache_folder();
    reporter.set_work("building trees");
    ready->sequence = frame_sequence(flags).value_or(FrameSequence{.time_s = flags.time_s, .shutter = shutter(flags)});
    ready->moving.emplace(std::move(scene), ready->sequence.time_of(ready->sequence.first), prepare, messages,
                          ready->sequence.shutter);
    ready->queue = machine.take();
    if (settings.integrator == IntegratorKind::Radiosity) {
        if (ready->moving->is_animated() && !flags.frames.empty()) {
            throw Error(ErrorCode::BadInput, "--frames: radiosity is solved for one time, and this scene moves; --time "
                                             "shows it at one (--camera-path and --turntable take it as it is)");
        }
        reporter.say_messages();
        if (flags.limits_memory) { // a picture for which there is no room is refused before its scene is solved
            const std::size_t film =
                Film::predicted_bytes(settings.width, settings.height, settings.aovs, light_layers_of(settings));
            check_render_memory(film, settings,
                                memory_to_render_in(*ready->queue, settings, max_memory_bytes(flags.radiosity)));
        }
        settings.radiosity = radiosity_look(flags.radiosity, ready->prepared(), settings.path.seed, reporter);
    }
    return ready;
}

PictureRecord picture_record(const PictureOptions& options, ReadyScene& ready, const Messages& messages) {
    PictureRecord record = {.scene = source_of(open_options(options.scene), ready.scene()),
                            .camera = {},
                            .settings = ready.settings,
                            .device = ready.queue->device_name(),
                            .frame = {},
                            .display = {}};
    if ((ready.settings.aovs & kAovIds) != 0) name_ids(ready.scene(), record.scene);
    tell_settings(options, ready.settings, record.scene);
    record.scene.made_up = messages.made_up();
    record.scene.left_out = messages.left_out();
    record.scene.load_seconds = ready.load_s;
    record.scene.build_seconds = ready.prepared().build_seconds;
    place_frame(ready.sequence.first, *ready.moving, {*ready.camera, ready.sequence}, record);
    return record;
}

} // namespace pertev
