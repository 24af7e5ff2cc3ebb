#include "session/moving_scene.h"

#include <algorithm>
#include <utility>

#include "render/place_meshes.h"
#include "render/scene_on_device.h"

namespace pertev {

MovingScene::MovingScene(Scene rest, std::optional<double> time_s, PrepareOptions options, Messages& messages)
    : posed_(std::move(rest), true), time_s_(time_s), options_(std::move(options)) {
    options_.centre = world_centre(posed_.scene());
    if (time_s) posed_.set_time(*time_s);
    prepared_ = prepare_scene(posed_.scene(), options_, messages);
    if (time_s) prepared_.poses = posed_.poses();
}

double MovingScene::end_s() const {
    double end_s = 0;
    for (const Animation& animation : scene().animations) end_s = std::max(end_s, animation.end_s());
    return end_s;
}

uint32_t MovingScene::set_time(double time_s, Messages& messages) {
    const bool was_behind = std::exchange(is_behind_, true), was_at_rest = prepared_.poses.empty();
    const SceneUpdate update = posed_.set_time(time_s);
    uint32_t parts = 0;
    if (was_behind) {
        prepared_ = prepare_scene(posed_.scene(), options_, messages);
        parts = kAllParts;
    } else if (!update.is_empty()) {
        if (changes_prepared(update)) prepared_ = update_scene(prepared_, posed_.scene(), update, messages);
        parts = parts_of(update);
    }
    if (was_at_rest && !posed_.poses().empty()) parts |= kPartShapes | kPartPoses;
    prepared_.poses = posed_.poses();
    is_behind_ = false;
    time_s_ = time_s;
    return parts;
}

} // namespace pertev
