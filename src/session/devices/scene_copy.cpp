#include "session/devices/scene_copy.h"

#include <utility>

namespace pertev {

SceneCopy::SceneCopy(Queue& queue, const PreparedScene& scene, const RenderSettings& settings)
    : scene_(queue), pictures_(scene_) {
    uploaded_ = std::async(std::launch::async, [this, &scene, settings] {
        const UseThreads use(scene_.queue().threads());
        scene_.set(scene, settings);
    });
}

void SceneCopy::wait() {
    if (uploaded_.valid()) uploaded_.get();
}

void SceneCopy::change(const PreparedScene& scene, uint32_t parts) {
    changed_scene_ = &scene;
    changed_parts_ |= parts;
}

PictureRenderer& SceneCopy::update(const RenderSettings& settings, bool keeps_before) {
    wait();
    const uint32_t parts = std::exchange(changed_parts_, 0);
    if (keeps_before) scene_.keep_instances();
    if (parts == kAllParts) {
        scene_.set(*changed_scene_, settings);
    } else if (parts != 0) {
        scene_.update(*changed_scene_, parts, settings);
    }
    scene_.set_tracer(settings);
    return pictures_;
}

} // namespace pertev
