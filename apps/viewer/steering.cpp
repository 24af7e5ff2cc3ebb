#include "apps/viewer/steering.h"

#include <utility>

#include "math/portable_math.h"
#include "session/position_text.h"
#include "settings/picture_flags.h"
#include "settings/setting_table.h"

namespace pertev {
namespace {

constexpr float kSteepest = 1.55334f; // radians above the horizon: 89 degrees
constexpr float kPixelFov = 1e-3f;    // radians; for the camera of a single pixel

/// Rotates `v` around the unit `axis`, counter-clockwise as seen from its tip.
Vec3 turned(Vec3 v, Vec3 axis, float angle) {
    float s = 0, c = 0;
    sin_cos(angle, s, c);
    return c * v + s * cross(axis, v) + (dot(axis, v) * (1 - c)) * axis;
}

struct Axes {
    Vec3 right, above, back; // unit axes of the view
};

Axes axes_of(const Pose& pose) {
    const Transform placed = look_at(pose.eye, pose.target, pose.up);
    return {column(placed, 0), column(placed, 1), column(placed, 2)};
}

/// Elevation of the view direction above the horizon.
float elevation(Vec3 back, Vec3 up) { return -asin(clamp(dot(back, normalize(up)), -1.0f, 1.0f)); }

/// Pitch that keeps the view away from the poles.
float allowed_pitch(Vec3 back, Vec3 up, float pitch) {
    const float now = elevation(back, up);
    return clamp(now + pitch, min(-kSteepest, now), max(kSteepest, now)) - now;
}

/// Returns the flags of a choice with the lens of `camera` if that differs from their defaults.
std::string flags_with_lens(PictureOptions options, const Camera& camera) {
    CameraChoice& choice = options.scene.camera;
    state_lens(camera, choice);
    if (camera.projection == Projection{}) choice.projection.reset();
    if (camera.aperture_radius == 0) choice.aperture.reset();
    std::string flags;
    for (const Setting& setting : all_settings()) {
        if (setting.group != SettingGroup::Camera) continue;
        const std::vector<std::string> texts = texts_of(options, setting);
        if (texts != texts_of({}, setting)) flags += flags_of(setting, texts);
    }
    flags.pop_back(); // a space
    return flags;
}

} // namespace

Pose pose_of(const Camera& camera, std::optional<Vec3> target, std::optional<Vec3> up, float distance) {
    const Transform& from = camera.world_from_camera;
    Pose pose;
    pose.eye = from.translation;
    pose.target = target.value_or(pose.eye - distance * column(from, 2));
    const Vec3 world_up = {0, 1, 0}, own_up = column(from, 1);
    const bool leans = abs(dot(column(from, 0), world_up)) > 1e-3f || dot(own_up, world_up) < 0.017f;
    pose.up = up.value_or(leans ? own_up : world_up);
    pose.centre = pose.target;
    return pose;
}

Camera camera_at(const Pose& pose, const Camera& lens) {
    Camera camera = lens;
    camera.world_from_camera = look_at(pose.eye, pose.target, pose.up);
    if (camera.aperture_radius == 0) camera.focus_distance = length(pose.target - pose.eye);
    return camera;
}

Pose fly(const Pose& pose, float right, float up, float forward) {
    const Axes axes = axes_of(pose);
    const Vec3 step = right * axes.right + up * normalize(pose.up) - forward * axes.back;
    return {pose.eye + step, pose.target + step, pose.up, pose.centre + step};
}

Pose orbit(const Pose& pose, float dx, float dy) {
    const Axes axes = axes_of(pose);
    const float yaw = -dx * kPi, pitch = allowed_pitch(axes.back, pose.up, -dy * kPi);
    const auto about = [&](Vec3 point) {
        const Vec3 pitched = turned(point - pose.centre, axes.right, pitch);
        return pose.centre + turned(pitched, normalize(pose.up), yaw);
    };
    return {about(pose.eye), about(pose.target), pose.up, pose.centre};
}

Pose turn(const Pose& pose, float dx, float dy, float fov_y) {
    const Axes axes = axes_of(pose);
    const float pitch = allowed_pitch(axes.back, pose.up, -dy * fov_y);
    const Vec3 ahead = turned(turned(pose.target - pose.eye, axes.right, pitch), normalize(pose.up), -dx * fov_y);
    return {pose.eye, pose.eye + ahead, pose.up, pose.eye + ahead};
}

Pose pan(const Pose& pose, float dx, float dy, float view_height) {
    const Axes axes = axes_of(pose);
    const Vec3 step = (-dx * view_height) * axes.right + (dy * view_height) * axes.above;
    return {pose.eye + step, pose.target + step, pose.up, pose.centre + step};
}

Pose zoom(const Pose& pose, float steps) {
    const float away = length(pose.centre - pose.eye);
    const float closer = away * (1 - pow(6.0f / 7.0f, steps));
    const Vec3 step = (closer / max(away, 1e-20f)) * (pose.centre - pose.eye);
    return {pose.eye + step, pose.target + step, pose.up, pose.centre};
}

float metres_of(const ClientMessage& message, float speed) {
    switch (message.pace) {
    case Pace::Normal:
        return speed * message.seconds;
    case Pace::Fast:
        return 4 * speed * message.seconds;
    case Pace::Slow:
        return 0.2f * speed * message.seconds;
    }
    return 0;
}

std::string camera_flags(const Pose& pose, const Camera& camera, const std::string& name, DoubleVec3 origin) {
    PictureOptions options;
    CameraChoice& choice = options.scene.camera;
    choice.camera = name;
    choice.eye = stated_position(pose.eye, origin), choice.target = stated_position(pose.target, origin);
    if (pose.up != Vec3{0, 1, 0}) choice.up = pose.up;
    return flags_with_lens(std::move(options), camera);
}

std::string scene_camera_flags(const Camera& camera, const std::string& name) {
    PictureOptions options;
    options.scene.camera.camera = name;
    return flags_with_lens(std::move(options), camera);
}

Camera camera_through(const Camera& camera, float aspect, float x, float y) {
    Camera through = camera;
    through.aperture_radius = 0;
    CameraView view = make_camera_view(through, 1, 1);
    view.half_width = view.half_height * aspect;
    const RayLine line = make_camera_line(view, Vec2{x, y}, Vec2{0.5f, 0.5f});
    through.world_from_camera = look_at({0, 0, 0}, line.direction, column(camera.world_from_camera, 1));
    through.world_from_camera.translation = line.origin;
    through.fov_y = kPixelFov;
    through.ortho_height = max(camera.ortho_height * 1e-3f, 1e-20f);
    return through;
}

} // namespace pertev
