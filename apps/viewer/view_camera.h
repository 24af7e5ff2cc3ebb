#pragma once

// The camera of the view: controlled by a guide (the initial camera, one of the scene's, a path of keys), which time
// may move, until a user moves it; from then on it is the user's. The lens is in ViewState, where settings change it.

#include <functional>
#include <string>

#include "apps/viewer/steering.h"
#include "scene/camera_path.h"
#include "scene/scene.h"
#include "session/writing/picture_metadata.h"

namespace pertev {

/// The pose of a camera of `scene`, which orbits its target or, without one, a point `distance` ahead. Its text
/// states the camera's position to the bit if a point in focus can be such a target.
Pose pose_of(const CameraSource& source, const Scene& scene, float distance);

/// The camera of the initial view, to which Home returns.
struct StartCamera {
    Camera camera;
    Pose pose;
    std::string name; // name among the scene's cameras, for flags; empty for none
    /// The camera when the scene is at a time; null: it does not move.
    std::function<CameraSource(double time_s)> at;
    /// The default view for a picture with this aspect ratio; null: the camera is no default.
    std::function<CameraSource(float aspect)> framed;
    bool moves = false;           // whether time moves it
    CameraPath path;              // if it has keys, they control the camera
    std::optional<float> focus_m; // requested focus; none: at its target
};

class ViewCamera {
public:
    static constexpr std::size_t kMaxKeys = 100;

    /// `start` and `scene` outlive the camera. `scene` is at the clock's time whenever seek() is called.
    ViewCamera(const StartCamera& start, const Scene& scene);

    /// The camera with this lens at its position.
    Camera camera(const Camera& lens) const;
    const Pose& pose() const { return pose_; }
    /// Returns whether a user has moved the camera.
    bool is_own() const { return is_own_; }
    /// Returns whether text (eye, target, up) states the camera's position to the bit.
    bool is_given_by_pose() const;
    /// Returns whether the camera is the scene's camera name() at its own position, which text does not state to the
    /// bit.
    bool is_of_scene() const;
    /// Returns whether time moves the camera.
    bool moves_with_time() const;
    bool is_at_start() const { return guide_ == Guide::Start; }
    const std::string& name() const { return name_; }

    // Functions that move the camera set the lens of its new guide; of a path all but the aperture.

    void return_to_start(std::optional<double> time_s, Camera& lens);
    /// Shows the scene's camera `index`. Returns false if there is none.
    bool use_scene_camera(uint32_t index, std::optional<double> time_s, Camera& lens);
    /// Follows the recorded path. Returns false if the path has no keys.
    bool follow_path(std::optional<double> time_s, Camera& lens);
    /// Moves the guide to `time_s`. Changes of the lens by the user are kept.
    void seek(std::optional<double> time_s, Camera& lens);

    /// The aspect ratio has changed: a default view shows the whole scene again.
    void fit(float aspect, Camera& lens);

    /// Applies a user's step: Move, Orbit, Look, Pan or Zoom.
    void step(const ClientMessage& message, const Camera& lens, float speed);
    void turn_about(Vec3 centre) { pose_.centre = centre; }

    const CameraPath& path() const { return path_; }
    /// Adds the current view as a key at that time, in place of an existing one. Returns false if there are too many.
    bool add_key(float time_s, const Camera& lens);
    void remove_key(uint32_t index);

    /// The flags of pertev render that reproduce this camera at the time.
    std::string flags(const Camera& lens, std::optional<double> time_s) const;

private:
    enum class Guide : uint8_t { Start, SceneCamera, Path };
    void place(const CameraSource& source, Camera& lens);
    CameraSource on_path(double time_s) const;

    const StartCamera& start_;
    const Scene& scene_;
    Guide guide_ = Guide::Start;
    uint32_t index_ = 0; // index among the scene's cameras
    Camera base_;        // position from its guide; replaced when a user moves it
    Pose pose_;
    std::string name_;
    float aspect_ = 0; // argument of fit(); 0: as at the start
    bool is_own_ = false;
    CameraPath path_;
    bool is_path_of_file_;
};

} // namespace pertev
