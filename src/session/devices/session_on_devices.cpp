#include "session/devices/session_on_devices.h"

namespace pertev {

SessionOnDevices::SessionOnDevices(std::span<const std::shared_ptr<Queue>> queues, const PreparedScene& scene,
                                   const Camera& camera, const RenderSettings& settings, const SharedWork& shared)
    : session_(*queues.front(), scene, camera, settings) {
    if (queues.size() < 2) return;
    if (shared.pictures) together_.emplace(queues, scene);
    if (shared.frames) {
        frames_together_.emplace(queues, scene, shared.after_loss);
        session_.pictures().share_frames(*frames_together_);
    }
    share_pictures(true);
}

void SessionOnDevices::share_pictures(bool by_all) {
    if (!together_) return;
    if (by_all) {
        session_.pictures().share(*together_);
    } else {
        session_.pictures().stop_sharing();
    }
}

void SessionOnDevices::update_scene(const PreparedScene& scene, uint32_t parts) {
    session_.update_scene(scene, parts);
    const bool is_known = session_.pictures().sharing() != nullptr; // it then gets the change from there
    if (together_ && !is_known) together_->change_scene(scene, parts);
}

} // namespace pertev
