#include "denoise/oidn/oidn_denoiser.h"

#include <algorithm>

#include "base/error.h"
#include "denoise/oidn/oidn_stages.h"
#include "device/launch.h"

namespace pertev {

void OidnDenoiser::add_features(const NoisyFrame& frame, const SceneView&) {
    PERTEV_CHECK(frame.width() * frame.height() == pixels_);
    launch_in(
        queue_, "mean_oidn_guides", window_,
        MeanOidnGuides{frame.view(), first_.data(), first_.data() + pixels_, 1.0f / static_cast<float>(++features_)});
}

void OidnDenoiser::add(const NoisyFrame& frame, const SceneView&, uint32_t sample) {
    PERTEV_CHECK(features_ > std::min(sample, kFeatures - 1) && frame.width() * frame.height() == pixels_);
    ++samples_;
    if (sample >= kFeatures) launch_in(queue_, "add_oidn_guides", window_, AddOidnGuides{frame.view(), sums()});
}

/// The arrays that hold what samples have left; the sums are last.
std::vector<PixelWords> OidnDenoiser::gathered() const {
    std::vector<PixelWords> arrays = {{first_.data(), 4}, {first_.data() + pixels_, 4}};
    for (uint32_t i = 0; i < OidnSums::kArrays; ++i) arrays.push_back({sums_.data() + std::size_t(i) * pixels_, 2});
    return arrays;
}

DenoiserState OidnDenoiser::state() const {
    const DenoiserStateSize size = state_size(pixels_);
    DenoiserState words(size.words, kMissingWord);
    std::fill(words.end() - static_cast<std::ptrdiff_t>(size.sums), words.end(), 0u);
    DenoiserHead{std::min(samples_, 1u), features_, false, {}}.write(words); // equal in all parts
    const std::size_t width = window_.picture_width == 0 ? window_.width : window_.picture_width;
    save_pixels(queue_, gathered(), pixels_, window_.y * width, window_.count(),
                std::span(words).subspan(DenoiserHead::kWords));
    return words;
}

void OidnDenoiser::restore(const DenoiserState& state) {
    const DenoiserHead head = DenoiserHead::read(state);
    if (state.size() != state_size(pixels_).words || head.features != kFeatures)
        throw Error(ErrorCode::BadInput, "what the denoiser has gathered is damaged");
    DenoiserState words(state.begin() + DenoiserHead::kWords, state.end());
    // Pixels without samples have the guides of a ray that hits nothing.
    std::replace(words.begin(), words.begin() + 8 * std::ptrdiff_t{pixels_}, kMissingWord, 0u);
    restore_pixels(queue_, gathered(), pixels_, 0, pixels_, words);
    samples_ = head.samples, features_ = head.features;
}

Image OidnDenoiser::apply(Image picture) {
    PERTEV_CHECK(samples_ > 0 && picture.width * picture.height == pixels_ && picture.channels >= 3);
    std::vector<Float4> colors(pixels_);
    const float* from = picture.pixels.data();
    for (Float4& color : colors) {
        color = {from[0], from[1], from[2], 0};
        from += picture.channels;
    }
    queue_.copy_to_device(filter_.color(), colors.data(), pixels_ * sizeof(Float4));
    launch(queue_, "finish_oidn_guides", pixels_,
           FinishOidnGuides{first_.data(), first_.data() + pixels_, kFeatures, sums(), filter_.albedo(),
                            filter_.normal()});
    filter_.run();
    queue_.copy_to_host(colors.data(), filter_.color(), pixels_ * sizeof(Float4));
    return with_colors(std::move(picture), colors);
}

} // namespace pertev
