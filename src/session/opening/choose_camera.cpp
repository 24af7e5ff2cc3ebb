#include "session/opening/choose_camera.h"

#include <charconv>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "base/limits.h"
#include "base/sink.h"
#include "formats/files/parse_number.h"
#include "scene/scene_origin.h"
#include "session/degrees.h"
#include "session/opening/calibrated_camera.h"
#include "session/position_text.h"
#include "session/survey/aim_camera.h"
#include "session/survey/default_camera.h"

namespace pertev {
namespace {

std::string text_of(Vec3 v) { return fmt::format("{},{},{}", v.x, v.y, v.z); }
std::string text_of(DoubleVec3 v) { return fmt::format("{},{},{}", v.x, v.y, v.z); }

/// Rounds `x` exactly as a notice prints it, so that the settings in the notice give the same picture.
float rounded(float x, int digits) {
    const std::string text = fmt::format("{:.{}g}", x, digits);
    float value = x;
    std::from_chars(text.data(), text.data() + text.size(), value);
    return value;
}

void place_camera(const CameraChoice& choice, const Scene& scene, Camera& camera) {
    if (!choice.pose.empty()) {
        camera.world_from_camera = placed_by_pose(choice, scene);
        return;
    }
    if (!choice.eye && !choice.target && !choice.up) return;
    const Transform& from = camera.world_from_camera;
    const Vec3 eye = choice.eye ? in_scene(scene, *choice.eye) : from.translation;
    const Vec3 target = choice.target ? in_scene(scene, *choice.target) : eye - column(from, 2);
    const Vec3 up = choice.up.value_or(Vec3{0, 1, 0});
    Transform placed = look_at(eye, target, up);
    if (!is_finite(placed.row0) && !choice.up) placed = look_at(eye, target, {0, 0, -1}); // straight down or up
    if (!is_finite(placed.row0) || !is_finite(placed.row1) || !is_finite(placed.row2)) {
        throw Error(ErrorCode::BadInput, "target", text_of(in_file(scene, target)),
                    fmt::format("the target must differ from `eye={}`{}", text_of(in_file(scene, eye)),
                                choice.up ? fmt::format(" and its direction from `up={}`", text_of(up)) : ""));
    }
    camera.world_from_camera = placed;
    if (choice.target) camera.focus_distance = length(target - eye);
}

/// Makes the camera for a scene without one and a choice without an eye.
Camera make_camera(const CameraChoice& choice, const Scene& scene, float aspect, Sink& sink) {
    if (!choice.target) return make_default_camera(scene, aspect, sink);
    PartMessages unsaid(sink); // discards messages about a view that is not used
    const Camera camera = make_default_camera(scene, aspect, unsaid);
    const Vec3 eye = camera.world_from_camera.translation;
    sink.make_up(fmt::format("the scene has no camera: a default eye position is used (`eye={}` `target={}`)",
                             position_text(scene, eye, 4), text_of(*choice.target)));
    return camera;
}

/// Gives a camera whose rays have become parallel the height that the one `before` shows at its target.
void flatten(const CameraChoice& choice, const Scene& scene, const Camera& before, Camera& camera) {
    const Vec3 eye = camera.world_from_camera.translation, forward = -column(camera.world_from_camera, 2);
    const Bounds3 bounds = bounds_of(scene);
    const float distance = choice.target ? length(in_scene(scene, *choice.target) - eye)
                                         : dot(0.5f * (bounds.lo + bounds.hi) - eye, forward);
    if (distance > 0) camera.ortho_height = min(view_height_at(before, distance), kMaxCoordinate);
}

/// If there is an aperture, but neither focus nor target was given, focuses the placed `camera` on what is in the
/// middle of its picture, or else on the distance of the scene's middle, with a notice.
void focus_in_the_middle(const CameraChoice& choice, const Scene& scene, Camera& camera, Sink& sink) {
    const bool has_target = choice.target && !choice.is_aimed;
    if (!(choice.aperture.value_or(0) > 0) || choice.focus || has_target) return;
    const std::optional<float> seen = distance_in_the_middle(scene, camera);
    const Bounds3 bounds = bounds_of(scene);
    const Vec3 middle = bounds.is_empty() ? Vec3{} : bounds.centre();
    const float away = length(middle - camera.world_from_camera.translation);
    const float distance = seen.value_or(max(away, 0x1p-40f));
    camera.focus_distance = rounded(distance, 4);
    sink.make_up(
        {"aperture", "",
         fmt::format("`focus` is not set: the lens focuses at {:.4g} m, {} (`focus={:.4g}`)", distance,
                     seen ? "the distance of the surface at the picture's centre"
                          : "the distance of the scene's centre, because the picture's centre shows no surface",
                     distance)});
}

/// Warns of parts of a choice without effect. `flattened` means that the camera's angle of view has become a height.
void warn_of_useless_parts(const CameraChoice& choice, const Camera& camera, bool flattened, Sink& sink) {
    const bool is_perspective = view_angle(camera) > 0;
    if (choice.view_height && is_perspective) {
        sink.warn(
            {"view_height", "", "the camera is perspective; the setting applies only with `projection=orthographic`"});
    }
    if (choice.fov_deg && !is_perspective && (!flattened || choice.view_height)) {
        sink.warn({"fov", "", "the camera is orthographic; set `view_height` instead"});
    }
    const std::pair<const char*, bool> of_lens[] = {{"focus", choice.focus.has_value()},
                                                    {"aperture_blades", choice.aperture_blades.has_value()},
                                                    {"aperture_rotation", choice.aperture_rotation.has_value()},
                                                    {"aperture_ratio", choice.aperture_ratio.has_value()}};
    for (const auto& [name, is_given] : of_lens) {
        if (!is_given || camera.aperture_radius > 0) continue;
        sink.warn({name, "", "the lens has no aperture, so everything is in focus; set `aperture`"});
    }
    if (choice.aperture_rotation && camera.aperture_radius > 0 && camera.aperture.blades == 0) {
        sink.warn({"aperture_rotation", "", "the aperture is a disk; set `aperture_blades`"});
    }
}

} // namespace

const Camera* scene_camera(const std::string& name, const Scene& scene) {
    if (name.empty()) return scene.cameras.empty() ? nullptr : &scene.cameras.front();
    for (const Camera& camera : scene.cameras) {
        if (camera.name == name) return &camera;
    }
    if (const auto number = parse_whole_number(name); number && *number < scene.cameras.size()) {
        return &scene.cameras[*number];
    }
    std::string known;
    for (std::size_t i = 0; i < scene.cameras.size(); ++i) {
        known += fmt::format("\n  {}  {}", i, scene.cameras[i].name.empty() ? "(no name)" : scene.cameras[i].name);
    }
    throw Error(ErrorCode::BadInput, "camera", name,
                fmt::format("the scene has no such camera; it has:{}", known.empty() ? "\n  none" : known));
}

void aim_camera(CameraChoice& choice, const Scene& scene, Sink& sink) {
    if (!choice.eye || choice.target) return;
    const Target target = target_from(scene, in_scene(scene, *choice.eye));
    choice.target = stated_position(scene, target.position, 6);
    choice.is_aimed = true;
    sink.make_up({"eye", "",
                  fmt::format("`target` is not set: the camera looks {} (`eye={}` `target={}`)",
                              target.is_middle ? "at the scene's centre" : "along the scene from its centre",
                              text_of(*choice.eye), position_text(scene, target.position, 6))});
}

Camera choose_camera(CameraChoice choice, const Scene& scene, float aspect, Sink& sink) {
    aim_camera(choice, scene, sink);
    Camera camera;
    if (const Camera* given = scene_camera(choice.camera, scene)) {
        camera = *given;
    } else if (!choice.places_camera()) {
        camera = make_camera(choice, scene, aspect, sink);
    }
    Vec3& position = camera.world_from_camera.translation;
    position = rounded_to_file(scene, position); // so that numbers in the coordinates of the file state it to the bit
    place_camera(choice, scene, camera);
    if (choice.fov_deg) camera.fov_y = choice.fov_y.value_or(*choice.fov_deg * kRadiansPerDegree);
    if (choice.aperture) camera.aperture_radius = *choice.aperture;
    check_aperture(choice); // that of a picture's metadata, too
    if (choice.aperture_blades) camera.aperture.blades = *choice.aperture_blades;
    if (choice.aperture_rotation) camera.aperture.rotation_deg = *choice.aperture_rotation;
    if (choice.aperture_ratio) camera.aperture.ratio = *choice.aperture_ratio;
    if (choice.focus) camera.focus_distance = *choice.focus;
    const Camera before = camera;
    if (choice.projection) camera.projection = *choice.projection;
    const bool flattened = view_angle(before) > 0 && view_angle(camera) == 0;
    if (flattened && !choice.view_height) flatten(choice, scene, before, camera);
    if (choice.view_height) camera.ortho_height = *choice.view_height;
    set_lens(choice, camera);
    focus_in_the_middle(choice, scene, camera, sink);
    warn_of_useless_parts(choice, camera, flattened, sink);
    offset_eye(choice, camera); // both eyes focus on what is in the middle between them
    return camera;
}

} // namespace pertev
