#pragma once

// A moving scene that can be rendered at any time: the scene at a time (scene/pose/posed_scene.h) and its prepared
// form, of which a time step updates only what moved. For use at several times:
//     MovingScene moving(open_scene(...), first_time_s, options, sink);
//     Session session(queue, moving.prepared(), camera, settings);
//     session.update_scene(moving.prepared(), moving.set_time(next_time_s, sink));
// The world's origin is that of the scene at rest, so the picture at a time does not depend on earlier times, to the
// bit.

#include <optional>

#include "render/update_scene.h"
#include "scene/pose/posed_scene.h"
#include "session/shutter.h"

namespace pertev {

class MovingScene {
public:
    /// Prepares `rest`, which has passed validate(), at `time_s`, or at rest without one. `options` contain no centre
    /// and no motions. Instances move while `shutter` is open, if there is a time. Throws as PosedScene::set_time and
    /// prepare_scene.
    MovingScene(Scene rest, std::optional<double> time_s, PrepareOptions options, Sink& sink,
                std::optional<Shutter> shutter = std::nullopt);
    MovingScene(const MovingScene&) = delete; // prepared() points into it
    MovingScene& operator=(const MovingScene&) = delete;

    const Scene& scene() const { return posed_.scene(); }
    const PreparedScene& prepared() const { return prepared_; }
    bool is_animated() const { return posed_.is_animated(); }
    double end_s() const;                                    // end of all animations, seconds; 0 without any
    std::optional<double> time_s() const { return time_s_; } // nothing at rest
    bool is_behind() const { return is_behind_; }            // the last change threw

    /// Moves to `time_s`. Returns the parts (ScenePart) of prepared() that Session::update_scene must upload, 0 if
    /// the scene of the picture does not change. Throws as the constructor; the next set_time then repairs the state.
    uint32_t set_time(double time_s, Sink& sink);

    /// Changes the scene as PosedScene::edit and keeps its time. Returns parts as set_time. A scene that is not
    /// animated is placed in the world as a fresh one with these values would be; made-up lights and the ground stay.
    /// A third move of instances in a large tree with others causes a warning that they can have their own. Throws as
    /// set_time and `edit`.
    uint32_t edit(const std::function<SceneUpdate(Scene&)>& edit, Sink& sink);

    /// The cameras of the scene at a time, without moving the scene there.
    std::vector<Camera> cameras_at(double time_s) { return posed_.placements_at(time_s).cameras; }

private:
    std::shared_ptr<const MotionKeys> motions_at(double time_s);
    uint32_t apply(SceneUpdate update, bool prepares_anew, Sink& sink);
    void count_baked_moves(const SceneUpdate& update, Sink& sink);

    PosedScene posed_;
    std::optional<Shutter> shutter_;
    std::optional<double> time_s_;
    PreparedScene prepared_;
    int baked_moves_ = 0;    // edits that moved instances without trees of their own
    bool is_behind_ = false; // an update threw, so prepared_ is outdated
    PrepareOptions options_;
};

} // namespace pertev
