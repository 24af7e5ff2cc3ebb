#include "session/devices/scene_copy.h"

#include <utility>

namespace pertev {

void SceneCopy::change(const PreparedScene& scene, uint32_t parts) {
    changed_scene_ = &scene;
    changed_parts_ |= parts;
}

PictureRenderer& SceneCopy::update(const DeviceScene& of_caller, const RenderSettings& settings, bool keeps_before) {
    const uint32_t parts = scene_.is_there() ? std::exchange(changed_parts_, 0) : kAllParts;
    if (keeps_before && scene_.is_there()) scene_.keep_instances();
    scene_.take_from(of_caller);
    if (parts == kAllParts) {
        changed_parts_ = 0;
        scene_.set(*changed_scene_, settings);
    } else if (parts != 0) {
        scene_.update(*changed_scene_, parts, settings);
    }
    scene_.set_tracer(settings);
    return pictures_;
}

} // namespace pertev
