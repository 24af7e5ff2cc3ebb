#pragma once

// The copy of a scene on a device that helps the caller's: it follows the caller's scene from picture to picture. What
// the caller's device has uploaded is copied from there, and not from the host again.

#include "session/picture_renderer.h"

namespace pertev {

class SceneCopy {
public:
    /// Makes a copy that the first update() fills; `queue` outlives this.
    SceneCopy(Queue& queue, const PreparedScene& scene) : scene_(queue), pictures_(scene_), changed_scene_(&scene) {}

    /// Takes parts (ScenePart) of the scene as they are at the next update().
    void change(const PreparedScene& scene, uint32_t parts);
    /// Brings the scene up to date with that of the caller's device, which does not change meanwhile, and returns what
    /// renders pictures of these settings. If `keeps_before`, the scene as it was is kept for the motion of a frame
    /// (DeviceScene::before). Throws as DeviceScene::set.
    PictureRenderer& update(const DeviceScene& of_caller, const RenderSettings& settings, bool keeps_before = false);
    PictureRenderer& pictures() { return pictures_; }
    double upload_seconds() const { return scene_.upload_seconds(); }

private:
    DeviceScene scene_;
    PictureRenderer pictures_;
    const PreparedScene* changed_scene_; // with the parts that are to be uploaded
    uint32_t changed_parts_ = kAllParts;
};

} // namespace pertev
