#pragma once

// A scene that moves, ready to be rendered at any of its times: the scene as it is at a time (scene/pose/posed_scene.h)
// and what is prepared of it, of which a step in time renews what moved and nothing else. For whoever shows times one
// after the other:
//     MovingScene moving(open_scene(...), first_time_s, options, messages);
//     Session session(queue, moving.prepared(), camera, settings);
//     session.update_scene(moving.prepared(), moving.set_time(next_time_s, messages));
// The world's centre is that of the scene at rest, so pictures at a time are the same, to the bit, whatever times came
// before.

#include <optional>

#include "render/update_scene.h"
#include "scene/pose/posed_scene.h"
#include "session/shutter.h"

namespace pertev {

class MovingScene {
public:
    /// Prepares `rest`, which has been through validate(), as it is at `time_s`; none: at rest. `options` name no
    /// centre and no motions. `shutter`: instances move while it is open; only where there is a time. Throws as
    /// PosedScene::set_time and prepare_scene.
    MovingScene(Scene rest, std::optional<double> time_s, PrepareOptions options, Messages& messages,
                std::optional<Shutter> shutter = std::nullopt);
    MovingScene(const MovingScene&) = delete; // prepared() points into it
    MovingScene& operator=(const MovingScene&) = delete;

    const Scene& scene() const { return posed_.scene(); }
    const PreparedScene& prepared() const { return prepared_; }
    bool is_animated() const { return posed_.is_animated(); }
    double end_s() const; // all animations have come to their end, seconds; 0 without any
    std::optional<double> time_s() const { return time_s_; } // none: at rest

    /// Goes to `time_s`. Returns the parts (ScenePart) that Session::update_scene must take of prepared(): 0 where the
    /// picture's scene stays as it is. Throws as the constructor; the next set_time then makes good for it.
    uint32_t set_time(double time_s, Messages& messages);

    /// The cameras of the scene at a time, without going there.
    std::vector<Camera> cameras_at(double time_s) { return posed_.places_at(time_s).cameras; }

private:
    std::shared_ptr<const MotionKeys> motions_at(double time_s);

    PosedScene posed_;
    std::optional<Shutter> shutter_;
    std::optional<double> time_s_;
    PreparedScene prepared_;
    bool is_behind_ = false; // an update threw: prepared_ is not of the scene
    PrepareOptions options_;
};

} // namespace pertev
