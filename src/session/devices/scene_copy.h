#pragma once

// The copy of a scene on a device that helps the caller's: it follows the caller's scene from picture to picture.

#include <future>

#include "session/picture_renderer.h"

namespace pertev {

class SceneCopy {
public:
    /// Starts to upload the scene, which must not change until wait() has returned; `queue` outlives this.
    SceneCopy(Queue& queue, const PreparedScene& scene, const RenderSettings& settings);

    /// Waits until the scene is on the device. Throws as DeviceScene::set.
    void wait();
    /// Takes parts (ScenePart) of the scene as they are at the next update().
    void change(const PreparedScene& scene, uint32_t parts);
    /// Brings the scene up to date and returns what renders pictures of these settings. If `keeps_before`, the scene
    /// as it was is kept for the motion of a frame (DeviceScene::before). Throws as wait().
    PictureRenderer& update(const RenderSettings& settings, bool keeps_before = false);
    PictureRenderer& pictures() { return pictures_; }
    double upload_seconds() const { return scene_.upload_seconds(); }

private:
    DeviceScene scene_;
    PictureRenderer pictures_;
    std::future<void> uploaded_;
    const PreparedScene* changed_scene_ = nullptr; // with the parts that are to be uploaded
    uint32_t changed_parts_ = 0;
};

} // namespace pertev
