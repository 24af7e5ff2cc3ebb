#include "denoise/enlarged_frame.h"

#include "base/error.h"
#include "denoise/anti_alias.h"
#include "device/launch.h"

namespace pertev {
namespace {

constexpr std::size_t kWideArrays = 3; // two shown pictures, and the one before it is anti-aliased

} // namespace

EnlargedFrame::EnlargedFrame(Queue& queue, uint32_t width, uint32_t height)
    : queue_(&queue), width_(width), height_(height), wide_(queue, kWideArrays * width * height, "enlarged frame"),
      objects_(queue, std::size_t(width) * height, "enlarged frame"),
      picture_(wide_.data() + std::size_t(2) * width * height) {}

std::size_t EnlargedFrame::predicted_bytes(uint32_t width, uint32_t height) {
    return std::size_t(width) * height * (kWideArrays * sizeof(Float4) + sizeof(uint32_t));
}

/// Of this class only object and shown picture are there.
HistoryView EnlargedFrame::history(uint32_t frame) const {
    HistoryView view = {};
    view.object = objects_.data();
    view.shown = wide_.data() + frame % 2 * std::size_t(width_) * height_;
    return view;
}

void EnlargedFrame::add(const NoisyFrame& features, const CameraView& camera, const CoarseLight& light,
                        const SceneView& scene, const PreviousScene& before, const ReconstructionSettings& settings,
                        bool has_history) {
    PERTEV_CHECK(features.width() == width_ && features.height() == height_);
    const uint32_t pixels = width_ * height_;
    const HistoryView now = history(frames_ + 1);
    Float4* const picture = settings.anti_alias ? picture_ : now.shown;
    launch(*queue_, "enlarge_picture", pixels,
           EnlargePicture{features.view(), light, camera, width_, height_, now.object, picture});
    if (settings.anti_alias) {
        const FrameCameras cameras = {camera, last_camera_, width_, height_};
        launch(*queue_, "anti_alias", pixels,
               AntiAlias{features.view(), picture, scene, before, cameras, now, history(frames_), has_history});
    }
    last_camera_ = camera;
    ++frames_;
}

} // namespace pertev
