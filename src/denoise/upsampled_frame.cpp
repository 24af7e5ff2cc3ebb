#include "denoise/upsampled_frame.h"

#include "base/error.h"
#include "denoise/anti_alias.h"
#include "denoise/sum_blocks.h"
#include "device/launch.h"

namespace pertev {
namespace {

constexpr std::size_t kWideArrays = 3; // two shown pictures, and one before anti-aliasing

} // namespace

UpsampledFrame::UpsampledFrame(Queue& queue, uint32_t width, uint32_t height)
    : queue_(&queue), width_(width), height_(height), wide_(queue, kWideArrays * width * height, "upsampled frame"),
      was_at_(queue, std::size_t(width) * height, "upsampled frame"),
      picture_(wide_.data() + std::size_t(2) * width * height),
      tones_(queue, float4s_of_tones(width, height), "upsampled frame") {}

Float4* UpsampledFrame::shown(uint32_t frame) const { return wide_.data() + frame % 2 * std::size_t(width_) * height_; }

RowBand UpsampledFrame::rows_of_light(const RowExchange* others, uint32_t height) const {
    const RowBand own = own_rows(others, height_).grown(AntiAlias::kReach, height_);
    if (own.is_empty()) return {};
    const uint64_t first = uint64_t(own.first) * height / height_, end = (uint64_t(own.end) * height - 1) / height_ + 1;
    return RowBand{static_cast<uint32_t>(first), static_cast<uint32_t>(end)}.grown(UpsamplePicture::kReach, height);
}

void UpsampledFrame::add(const NoisyFrame& features, const CameraView& camera, const CoarseLight& light,
                         const SteadyLight& steady, const SceneView& scene, const PreviousScene& before,
                         const ReconstructionSettings& settings, bool has_history, RowExchange* others) {
    PERTEV_CHECK(features.width() == width_ && features.height() == height_);
    const RowBand own = own_rows(others, height_), of_picture = own.grown(AntiAlias::kReach, height_);
    if (others != nullptr) others->take(features.rows(), of_picture);
    Float4* const now = shown(frames_ + 1);
    Float4* const picture = settings.anti_alias ? picture_ : now;
    launch_in_band(*queue_, "upsample_picture", of_picture, width_,
                   UpsamplePicture{features.view(), light, camera, width_, height_, scene, before, last_camera_,
                                   was_at_.data(), picture, has_history});
    if (settings.anti_alias) {
        launch(*queue_, "anti_alias", own.count() * width_,
               AntiAlias{picture, features.view().emission, was_at_.data(), shown(frames_), now, width_, height_,
                         has_history, steady, own});
    }
    last_camera_ = camera;
    ++frames_;
}

} // namespace pertev
