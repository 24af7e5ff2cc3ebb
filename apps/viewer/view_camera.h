#pragma once

// The camera of the view: led by something (the one of the start, one of the scene's, a path of keys), which time may
// move, until somebody steps; from then on it is their own. The lens lies in ViewState, where settings change it.

#include <functional>
#include <string>

#include "apps/viewer/steering.h"
#include "scene/camera_path.h"
#include "scene/scene.h"
#include "session/writing/picture_metadata.h"

namespace pertev {

/// The pose of a camera of `scene`, which turns about its target or, where none was asked for, about a point `distance`
/// ahead. Its words say the camera's place to the bit wherever what is in focus can be such a target.
Pose pose_of(const CameraSource& source, const Scene& scene, float distance);

/// What the view begins with, and goes home to.
struct StartCamera {
    Camera camera;
    Pose pose;
    std::string name; // of the scene's cameras, for flags; empty for none
    /// Where the camera is once the scene is at a time; null: it stands.
    std::function<CameraSource(double time_s)> at;
    /// The view that is made up for a picture of this width / height; null: the camera is not made up.
    std::function<CameraSource(float aspect)> framed;
    bool moves = false;           // with time
    CameraPath path;              // where it has keys, that leads it
    std::optional<float> focus_m; // that was asked for; none: at what it looks at
};

class ViewCamera {
public:
    static constexpr std::size_t kMostKeys = 100;

    /// Both outlive it. `scene` is at the clock's time whenever go_to() is called.
    ViewCamera(const StartCamera& start, const Scene& scene);

    /// With this lens, at its place.
    Camera camera(const Camera& lens) const;
    const Pose& pose() const { return pose_; }
    /// Somebody has moved it.
    bool is_own() const { return is_own_; }
    /// Whether words (eye, target, up) say its place to the bit.
    bool is_said_by_pose() const;
    /// Whether time moves it.
    bool moves_with_time() const;
    bool is_at_start() const { return guide_ == Guide::Start; }
    const std::string& name() const { return name_; }

    // Each of these gives the lens of whatever leads the camera then; of a path all but the aperture.

    void go_home(std::optional<double> time_s, Camera& lens);
    /// False: there is no such one.
    bool take_scene_camera(uint32_t index, std::optional<double> time_s, Camera& lens);
    /// False: it has no keys.
    bool follow_path(std::optional<double> time_s, Camera& lens);
    /// Time has come to another `time_s`: whatever leads the camera is there. What of the lens was set by hand stays.
    void go_to(std::optional<double> time_s, Camera& lens);

    /// The picture has another width / height: a view that is made up shows the whole thing again.
    void fit(float aspect, Camera& lens);

    /// A step of somebody: Move, Orbit, Look, Pan or Zoom.
    void step(const ClientMessage& message, const Camera& lens, float speed);
    void turn_about(Vec3 centre) { pose_.centre = centre; }

    const CameraPath& path() const { return path_; }
    /// The present view, as a key at that time, in place of one that is there. False: there are too many.
    bool add_key(float time_s, const Camera& lens);
    void remove_key(uint32_t index);

    /// The flags of pertev render that place this camera at the time.
    std::string flags(const Camera& lens, std::optional<double> time_s) const;

private:
    enum class Guide : uint8_t { Start, SceneCamera, Path };
    void place(const CameraSource& source, Camera& lens);
    CameraSource on_path(double time_s) const;

    const StartCamera& start_;
    const Scene& scene_;
    Guide guide_ = Guide::Start;
    uint32_t index_ = 0; // of the scene's cameras
    Camera base_;        // as whatever leads it has it; its place until somebody steps
    Pose pose_;
    std::string name_;
    float aspect_ = 0; // of fit(); 0: as at the start
    bool is_own_ = false;
    CameraPath path_;
    bool is_path_of_file_;
};

} // namespace pertev
