#include "session/opening/moving_camera.h"

#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "math/portable_math.h"
#include "scene/scene_origin.h"
#include "session/degrees.h"

namespace pertev {
namespace {

bool has_own_camera(const CameraChoice& choice, const Scene& scene) {
    return scene_camera(choice.camera, scene) != nullptr;
}

} // namespace

MovingCamera::MovingCamera(CameraChoice choice, std::optional<CameraPath> path, const Scene& rest, float aspect,
                           Sink& sink)
    : choice_(std::move(choice)), path_(std::move(path)), aspect_(aspect) {
    const bool makes_it_up = !path_ && !choice_.places_camera() && !has_own_camera(choice_, rest);
    aim_camera(choice_, rest, sink);
    const Camera at_rest = choose_camera(choice_at(std::nullopt), rest, aspect, sink);
    if (makes_it_up) made_up_ = at_rest;
    const bool is_focused = choice_.focus || (choice_.target && !choice_.is_aimed) || path_;
    if (choice_.aperture.value_or(0) > 0 && !is_focused) choice_.focus = at_rest.focus_distance;
    if (choice_.projection && view_angle(at_rest) == 0) choice_.view_height = at_rest.ortho_height;
    const Vec3 eye = at_rest.world_from_camera.translation;
    const Vec3 seen = eye - at_rest.focus_distance * column(at_rest.world_from_camera, 2);
    const Bounds3 bounds = choice_.target || made_up_ ? Bounds3() : bounds_of(rest); // taking bounds costs time
    middle_ = choice_.target ? in_scene(rest, *choice_.target) : bounds.is_empty() ? seen : bounds.centre();
}

CameraChoice MovingCamera::choice_at(std::optional<double> time_s) const {
    CameraChoice choice = choice_;
    if (!path_) return choice;
    const CameraKey key = sample_path(*path_, time_s.value_or(path_->keys.front().time_s));
    choice.eye = key.eye;
    choice.target = key.target;
    choice.up = key.up;
    if (key.fov_deg > 0) choice.fov_deg = key.fov_deg;
    return choice;
}

Camera MovingCamera::at(const Scene& scene, std::optional<double> time_s) const {
    if (made_up_) return *made_up_;
    try {
        return choose_camera(choice_at(time_s), scene, aspect_, nobody()); // messages were already reported
    } catch (const Error& error) {
        if (!path_) throw;
        Remark remark = error.remark();
        remark.reason += fmt::format(" (the camera's path at {} s)", time_s.value_or(0));
        throw Error(error.code(), std::move(remark));
    }
}

Camera MovingCamera::turned(const Camera& camera, double turn) const {
    if (turn == 0) return camera;
    const float angle = static_cast<float>(turn - static_cast<double>(static_cast<int64_t>(turn))) * kTwoPi;
    const float c = cos(angle), s = sin(angle);
    const Transform round = {{c, 0, s}, {0, 1, 0}, {-s, 0, c}, {}};
    Camera result = camera;
    result.world_from_camera = compose(round, moved_to(camera.world_from_camera, middle_));
    result.world_from_camera.translation += middle_;
    return result;
}

} // namespace pertev
