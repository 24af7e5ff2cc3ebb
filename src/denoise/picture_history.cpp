#include "denoise/picture_history.h"

#include <algorithm>

#include "base/error.h"
#include "denoise/mix_history.h"
#include "device/launch.h"
#include "render/noisy_frame.h"

namespace pertev {
namespace {

constexpr std::size_t kWideHistory = 5, kNarrowHistory = 3; // arrays of each kind

} // namespace

PictureHistory::PictureHistory(Queue& queue, uint32_t width, uint32_t height, uint32_t samples, uint32_t frames)
    : queue_(&queue), pixels_(std::size_t(width) * height), width_(width), height_(height),
      wide_(queue, kWideHistory * pixels_, "history of denoised pictures"),
      narrow_(queue, kNarrowHistory * pixels_, "history of denoised pictures"), samples_(static_cast<float>(samples)),
      most_(samples_ * static_cast<float>(frames - 1)) {}

void PictureHistory::follow(const NoisyFrame& centres, const PictureGuide& guide, const CameraView& now,
                            const SceneView& scene, const PreviousScene& before) {
    PERTEV_CHECK(is_there_);
    launch(*queue_, "reproject_history", width_ * height_,
           ReprojectHistory{centres.view(),
                            guide,
                            scene,
                            before,
                            {now, camera_, width_, height_},
                            kept(),
                            reprojected(),
                            samples_,
                            centres.splits_light()});
}

void PictureHistory::cut() {
    is_there_ = false;
    wide_.zero();
    narrow_.zero();
}

void PictureHistory::mix(const PictureSums& sums, const SignalsView& signals, const Float4* guide, SignalsView free,
                         bool has_gloss, const CameraView& camera) {
    const uint32_t pixels = width_ * height_;
    const HistoryMix mix = {sums, signals, of_sample(), reprojected(), most_, has_gloss};
    const auto average = [&](const Float4* from, Float4* to, int reach, int step) {
        launch(*queue_, "average_difference", pixels, AverageDifference{guide, from, to, width_, height_, reach, step});
    };
    launch(*queue_, "compare_history", pixels, CompareHistory{mix, kept().diffuse});
    average(kept().diffuse, free.diffuse, 1, 1);
    average(free.diffuse, free.gloss, 3, 3);
    launch(*queue_, "mix_history", pixels, MixHistory{mix, free.diffuse, free.gloss, guide, kept()});
    camera_ = camera;
    is_there_ = true;
}

std::vector<PictureHistory::Array> PictureHistory::arrays() const {
    const std::size_t wide_bytes = pixels_ * sizeof(Float4);
    return {
        {wide(0), wide_bytes}, {wide(1), wide_bytes}, {wide(2), wide_bytes}, {narrow_.data(), pixels_ * sizeof(Vec2)}};
}

std::vector<std::vector<std::byte>> PictureHistory::save() const {
    PERTEV_CHECK(is_there_);
    std::vector<std::vector<std::byte>> saved;
    for (const Array& array : arrays()) {
        saved.emplace_back(array.bytes);
        queue_->copy_to_host(saved.back().data(), array.data, array.bytes);
    }
    return saved;
}

void PictureHistory::restore(std::span<const std::vector<std::byte>> saved, const CameraView& camera) {
    const std::vector<Array> to = arrays();
    const bool fits = std::ranges::equal(saved, to, {}, &std::vector<std::byte>::size, &Array::bytes);
    if (!fits) throw Error(ErrorCode::BadInput, "the history of frames does not fit these settings, or it is damaged");
    for (std::size_t i = 0; i < to.size(); ++i) queue_->copy_to_device(to[i].data, saved[i].data(), to[i].bytes);
    camera_ = camera;
    is_there_ = true;
}

} // namespace pertev
