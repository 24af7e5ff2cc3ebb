#include "apps/viewer/view_camera.h"

#include <algorithm>

#include <fmt/format.h>

#include "math/portable_math.h"
#include "scene/scene_origin.h"
#include "session/degrees.h"
#include "session/opening/choose_camera.h"

namespace pertev {
namespace {

constexpr float kMinFov = 0.01f, kMaxFov = 179; // degrees; the limits of a path's file
constexpr int kMaxTargets = 256;                // number of targets tried to state a position to the bit
constexpr float kFarthest = 1e9f;               // metres; limit of the camera's position

bool is_finite_transform(const Transform& m) {
    return is_finite(m.row0) && is_finite(m.row1) && is_finite(m.row2) && is_finite(m.translation);
}

/// Sets `now` unless the user has changed the lens from `before`.
void follow(float& lens, float before, float now) {
    if (lens == before) lens = now;
}

} // namespace

Pose pose_of(const CameraSource& source, const Scene& scene, float distance) {
    const auto requested = source.target ? std::optional(in_scene(scene, *source.target)) : std::nullopt;
    Pose pose = pose_of(source.camera, requested, source.up, distance);
    const Transform& placed = source.camera.world_from_camera;
    if (requested || look_at(pose.eye, pose.target, pose.up) == placed) return pose;
    // Takes the first point near the focus that reproduces these axes; most differ in the last digit.
    for (int i = 0; i < kMaxTargets; ++i) {
        const float away = source.camera.focus_distance * (1 + static_cast<float>(i) / kMaxTargets);
        const Vec3 target = rounded_to_file(scene, pose.eye - away * column(placed, 2));
        if (!(look_at(pose.eye, target, pose.up) == placed)) continue;
        pose.target = target;
        break;
    }
    return pose;
}

ViewCamera::ViewCamera(const StartCamera& start, const Scene& scene)
    : start_(start), scene_(scene), base_(start.camera), pose_(start.pose), name_(start.name), path_(start.path),
      is_path_of_file_(!start.path.keys.empty()) {
    if (is_path_of_file_) guide_ = Guide::Path;
    for (CameraKey& key : path_.keys) { // so that the user's own keys can join them
        if (key.fov_deg == 0) key.fov_deg = degrees_for(start.camera.fov_y);
    }
}

Camera ViewCamera::camera(const Camera& lens) const {
    Camera camera = base_;
    if (camera.intrinsics && lens.fov_y != base_.fov_y) { // the slider zooms
        const double zoom = static_cast<double>(tan(0.5f * base_.fov_y) / tan(0.5f * lens.fov_y));
        camera.intrinsics->focal_x *= zoom, camera.intrinsics->focal_y *= zoom;
    }
    camera.fov_y = lens.fov_y;
    camera.aperture_radius = lens.aperture_radius;
    camera.focus_distance = lens.focus_distance;
    return is_own_ ? camera_at(pose_, camera) : camera;
}

bool ViewCamera::is_given_by_pose() const {
    return is_own_ || look_at(pose_.eye, pose_.target, pose_.up) == base_.world_from_camera;
}

bool ViewCamera::is_of_scene() const {
    if (is_given_by_pose() || name_.empty()) return false;
    const Camera& own = *scene_camera(name_, scene_);
    return own.world_from_camera == base_.world_from_camera && own.projection == base_.projection &&
           own.ortho_height == base_.ortho_height;
}

bool ViewCamera::moves_with_time() const {
    if (is_own_) return false;
    switch (guide_) {
    case Guide::Start:
        return start_.moves;
    case Guide::SceneCamera:
        return !scene_.animations.empty();
    case Guide::Path:
        return path_.keys.size() > 1;
    }
    return false;
}

void ViewCamera::place(const CameraSource& source, Camera& lens) {
    const Camera before = base_;
    base_ = source.camera;
    pose_ = pose_of(source, scene_, length(pose_.centre - pose_.eye));
    is_own_ = false;
    follow(lens.fov_y, before.fov_y, base_.fov_y);
    follow(lens.aperture_radius, before.aperture_radius, base_.aperture_radius);
    follow(lens.focus_distance, before.focus_distance, base_.focus_distance);
}

CameraSource ViewCamera::on_path(double time_s) const {
    const CameraKey key = sample_path(path_, time_s);
    CameraSource source = {.camera = start_.camera, .name = {}, .target = key.target, .up = key.up};
    const Vec3 eye = in_scene(scene_, key.eye), target = in_scene(scene_, key.target);
    source.camera.world_from_camera = look_at(eye, target, key.up);
    source.camera.fov_y = key.fov_deg * kRadiansPerDegree;
    source.camera.focus_distance = start_.focus_m.value_or(length(target - eye));
    return source;
}

void ViewCamera::seek(std::optional<double> time_s, Camera& lens) {
    if (is_own_) return;
    switch (guide_) {
    case Guide::Start:
        if (start_.at && time_s && !start_.framed) place(start_.at(*time_s), lens);
        return;
    case Guide::SceneCamera:
        if (!(scene_.cameras[index_] == base_)) place({.camera = scene_.cameras[index_]}, lens);
        return;
    case Guide::Path: {
        const CameraSource source = on_path(time_s.value_or(path_.keys.front().time_s));
        // Where a path's eye passes through its target there is no view, so the previous one stays.
        if (is_finite_transform(source.camera.world_from_camera)) place(source, lens);
        return;
    }
    }
}

void ViewCamera::return_to_start(std::optional<double> time_s, Camera& lens) {
    if (is_path_of_file_) {
        lens = start_.camera;
        follow_path(time_s, lens);
        return;
    }
    guide_ = Guide::Start;
    name_ = start_.name;
    base_ = lens = start_.camera;
    pose_ = start_.pose;
    is_own_ = false;
    if (aspect_ > 0) fit(aspect_, lens);
    seek(time_s, lens);
}

void ViewCamera::fit(float aspect, Camera& lens) {
    aspect_ = aspect;
    if (start_.framed && guide_ == Guide::Start && !is_own_) place(start_.framed(aspect), lens);
}

bool ViewCamera::use_scene_camera(uint32_t index, std::optional<double> time_s, Camera& lens) {
    if (index >= scene_.cameras.size()) return false;
    guide_ = Guide::SceneCamera;
    index_ = index;
    name_ = fmt::format("{}", index);
    pose_ = start_.pose; // for its viewing distance
    place({.camera = scene_.cameras[index]}, lens);
    lens = base_;
    seek(time_s, lens);
    return true;
}

bool ViewCamera::follow_path(std::optional<double> time_s, Camera& lens) {
    if (path_.keys.empty()) return false;
    guide_ = Guide::Path;
    name_ = start_.name;
    is_own_ = false;
    base_ = start_.camera;
    pose_ = start_.pose;
    seek(time_s, lens);
    lens.fov_y = base_.fov_y; // keys define these
    lens.focus_distance = base_.focus_distance;
    return true;
}

void ViewCamera::step(const ClientMessage& message, const Camera& lens, float speed) {
    const Pose before = pose_;
    if (!is_own_) pose_.target = pose_.centre; // the orbit's centre becomes the target
    const Camera now = camera(lens);
    const float angle = view_angle(now);
    if (message.kind == MessageKind::Move) {
        const float metres = metres_of(message, speed);
        pose_ = fly(pose_, metres * message.right, metres * message.up, metres * message.forward);
    } else if (message.kind == MessageKind::Orbit) {
        pose_ = orbit(pose_, message.dx, message.dy);
    } else if (message.kind == MessageKind::Look) {
        pose_ = turn(pose_, message.dx, message.dy, angle > 0 ? angle : 1.0f);
    } else if (message.kind == MessageKind::Pan) {
        pose_ = pan(pose_, message.dx, message.dy, view_height_at(now, max(length(pose_.centre - pose_.eye), 1e-6f)));
    } else if (angle == 0) {
        base_.ortho_height = clamp(base_.ortho_height * pow(6.0f / 7.0f, message.steps), 1e-6f, 1e12f);
    } else {
        pose_ = zoom(pose_, message.steps);
    }
    pose_.eye = rounded_to_file(scene_, pose_.eye);
    pose_.target = rounded_to_file(scene_, pose_.target);
    const bool is_good = is_finite_transform(look_at(pose_.eye, pose_.target, pose_.up)) &&
                         max_component(abs(pose_.eye)) < kFarthest && max_component(abs(pose_.target)) < kFarthest;
    if (!is_good) pose_ = before; // the step went too far
    is_own_ = true;
}

bool ViewCamera::add_key(float time_s, const Camera& lens) {
    const CameraKey key = {.time_s = static_cast<double>(time_s),
                           .eye = in_file(scene_, pose_.eye),
                           .target = in_file(scene_, pose_.target),
                           .up = pose_.up,
                           .fov_deg = clamp(degrees_for(lens.fov_y), kMinFov, kMaxFov)};
    std::vector<CameraKey>& keys = path_.keys;
    const auto next = std::ranges::lower_bound(keys, key.time_s, {}, &CameraKey::time_s);
    if (next != keys.end() && next->time_s == key.time_s) {
        *next = key;
    } else if (keys.size() < kMaxKeys) {
        keys.insert(next, key);
    } else {
        return false;
    }
    is_path_of_file_ = false;
    return true;
}

void ViewCamera::remove_key(uint32_t index) {
    if (index >= path_.keys.size()) return;
    path_.keys.erase(path_.keys.begin() + index);
    is_path_of_file_ = false;
    if (path_.keys.empty() && guide_ == Guide::Path) { // it stays at its position
        guide_ = Guide::Start;
        is_own_ = true;
    }
}

std::string ViewCamera::flags(const Camera& lens, std::optional<double> time_s) const {
    const std::string time = time_s ? fmt::format(" --time {}", *time_s) : "";
    if (is_of_scene()) return scene_camera_flags(camera(lens), name_) + time;
    return camera_flags(pose_, camera(lens), name_, scene_.origin_in_file) + time;
}

} // namespace pertev
