#include "apps/viewer/start_viewer.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "apps/viewer/panel_phrases.h"
#include "formats/files/file_choices.h"
#include "formats/read_camera_path.h"
#include "integrators/radiosity/radiosity_display_settings.h"
#include "scene/scene_origin.h"
#include "session/check_integrator.h"
#include "session/pictures/choose_display.h"
#include "settings/value_names.h"

namespace pertev {
namespace {

constexpr double kTurntableFps = 24; // the default of the setting `fps`

/// The text of a scene's camera for --camera; empty where there is none.
std::string camera_name(const SceneOptions& options, const Scene& scene) {
    if (!options.camera.camera.empty()) return options.camera.camera;
    return scene.cameras.empty() ? "" : "0";
}

/// Orbits as --turntable N does at 24 frames a second. Positions are given as eye, target and up, so that flags can
/// reproduce them; they equal those of render's frames except for rounding.
CameraSource turned_camera(const RenderSetup& ready, double time_s) {
    const double frames = std::fmod(time_s * kTurntableFps, ready.sequence.turntable);
    CameraSource source = camera_at(*ready.camera, ready.scene(), time_s, frames / ready.sequence.turntable);
    if (frames == 0) return source;
    const Pose pose = pose_of(source.camera, {}, {}, source.camera.focus_distance);
    source.camera.world_from_camera = look_at(pose.eye, pose.target, pose.up);
    source.target = in_file(ready.scene(), pose.target);
    source.up = pose.up;
    return source;
}

/// Says in the panel which animation plays and which scene is shown, where the file has several, and by which words the
/// others are chosen.
void report_choices(const Scene& scene, ViewerStart& start) {
    const auto report = [&](const char* label, const std::string& chosen, const std::vector<std::string>& all,
                            const char* flag) {
        if (chosen.empty()) return;
        start.about.emplace_back(label, fmt::format("{} of {} ({})", chosen, fmt::join(all, ", "), flag));
    };
    report("animation", clip_choice(scene.clips), list_clips(scene.clips), "--animation");
    report("variant of the materials", material_variant_choice(scene), list_material_variants(scene), "--variant");
    report("scene of the file", file_scene_choice(scene), list_file_scenes(scene), "--file-scene");
}

/// Sets how time moves the camera, and when all motion ends.
void let_time_move(const PictureOptions& options, const RenderSetup& ready, ViewerStart& start) {
    const MovingScene& moving = *ready.moving;
    const uint32_t turntable = options.turntable;
    const bool is_still = moving.is_animated() && ready.settings.radiosity->solution != nullptr;
    start.is_animated = moving.is_animated() && !is_still;
    start.clock = {.end_s = is_still ? 0 : moving.end_s(), .time_s = moving.time_s(), .plays = !moving.time_s()};
    if (is_still) {
        start.still_s = moving.time_s();
        start.why_still = fmt::format("is shown {}: radiosity is solved for one time",
                                      start.still_s ? fmt::format("at {:g} s", *start.still_s) : "at rest");
    }
    if (!options.camera_path.empty()) {
        start.camera.path = read_camera_path(options.camera_path);
        start.clock.end_s = std::max(start.clock.end_s, start.camera.path.keys.back().time_s);
    }
    if (options.scene.camera.focus) start.camera.focus_m = *options.scene.camera.focus;
    if (turntable > 0) {
        start.clock.end_s = std::max(start.clock.end_s, turntable / kTurntableFps);
        start.camera.at = [&ready](double time_s) { return turned_camera(ready, time_s); };
    } else if (options.camera_path.empty()) {
        start.camera.at = [&ready](double time_s) { return camera_at(*ready.camera, ready.scene(), time_s, 0); };
    }
    start.camera.moves = start.is_animated || turntable > 0;
    const SceneOptions& scene = options.scene;
    const bool is_made_up = ready.scene().cameras.empty() && !scene.camera.eye && options.camera_path.empty();
    if (is_made_up && turntable == 0 && !moving.is_animated()) {
        start.camera.framed = [&ready, choice = scene.camera](float aspect) {
            const MovingCamera framed(choice, std::nullopt, ready.scene(), aspect, nobody()); // already reported
            return camera_at(framed, ready.scene(), std::nullopt, 0);
        };
    }
}

/// Returns the first pose. The view orbits the point in the middle of the picture, unless a target was given.
Pose start_pose(const PictureRecord& record, const Scene& scene, FrameSource& source, float scene_size) {
    const Camera& camera = record.camera.camera;
    float distance = 0.5f * scene_size;
    if (!record.camera.target) {
        if (const auto point = source.pick(camera, 0.5f, 0.5f)) distance = max(point->distance, 1e-3f * scene_size);
    }
    return pose_of(record.camera, scene, distance);
}

/// Integrators that would show the scene as black, and why.
std::vector<std::pair<IntegratorKind, std::string>> dark_integrators(RenderSettings settings, const Scene& scene) {
    std::vector<std::pair<IntegratorKind, std::string>> dark;
    for (const std::string& name : integrator_names()) {
        set_integrator(settings, name);
        const std::optional<Remark> is_dark = why_dark(settings, scene);
        std::string why = is_dark ? panel_phrase(*is_dark) : "";
        if (why.empty() && is_solved(settings.integrator) && !settings.radiosity->solution) {
            why = "radiosity is solved before the first frame: start pertev view --integrator radiosity";
        }
        if (!why.empty()) dark.emplace_back(settings.integrator, std::move(why));
    }
    return dark;
}

} // namespace

ViewerStart start_viewer(const PictureOptions& options, const RenderSetup& ready, const PictureRecord& record,
                         const Display& display, SessionFrames& source) {
    const Camera& camera = record.camera.camera;
    ViewerStart start;
    start.scene = &ready.scene();
    start.camera.camera = camera;
    start.record = record;
    start.options = options;
    start.view.options = options;
    start.view.options.render = ready.settings;
    if (!options.size && !camera.intrinsics) { // intrinsics hold for pictures of one shape
        start.view.window_pixels = uint64_t(ready.settings.width) * ready.settings.height;
    }
    start.view.display = display;
    start.view.finds_exposure = is_metered(options);
    start.view.dark = dark_integrators(ready.settings, ready.scene());
    start.view.lens = camera;
    start.view.on_cuda = ready.queue->is_cuda();
    RenderSettings& shown = start.view.options.render;
    if (!shown.frame_depth) shown.frame_depth = options.is_given("max_depth") ? shown.path.max_depth : kMovingDepth;
    if (start.view.finds_exposure) {
        source.begin_exposed({.camera = camera, .view = start.view}, start.view.display.exposure_stops);
        start.view.display.exposure_stops = 0;
    }
    start.camera.name = camera_name(options.scene, ready.scene());
    const float size = length(bounds_of(ready.scene()).size());
    start.speed = 0.12f * size;
    start.camera.pose = start_pose(record, ready.scene(), source, size);
    report_choices(ready.scene(), start);
    let_time_move(options, ready, start);
    return start;
}

} // namespace pertev
