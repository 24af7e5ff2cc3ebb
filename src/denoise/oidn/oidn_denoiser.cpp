#include "denoise/oidn/oidn_denoiser.h"

#include "base/error.h"
#include "denoise/oidn/oidn_stages.h"
#include "device/launch.h"

namespace pertev {

void OidnDenoiser::add_features(const NoisyFrame& frame, const SceneView&) {
    PERTEV_CHECK(frame.width() * frame.height() == pixels_);
    launch_in(queue_, "mean_oidn_guides", window_,
              MeanOidnGuides{frame.view(), filter_.albedo(), filter_.normal(), 1.0f / static_cast<float>(++features_)});
}

void OidnDenoiser::add(const NoisyFrame& frame, const SceneView& scene) {
    if (samples_++ >= features_) add_features(frame, scene);
}

DenoiserState OidnDenoiser::state() const {
    DenoiserState words(state_words(pixels_), kMissingWord);
    DenoiserHead{samples_, features_, false, {}}.write(words);
    const std::size_t width = window_.picture_width == 0 ? window_.width : window_.picture_width;
    save_pixels(queue_, guides(), pixels_, window_.y * width, window_.count(),
                std::span(words).subspan(DenoiserHead::kWords));
    return words;
}

void OidnDenoiser::restore(const DenoiserState& state) {
    const DenoiserHead head = DenoiserHead::read(state);
    if (state.size() != state_words(pixels_))
        throw Error(ErrorCode::BadInput, "what the denoiser has gathered is damaged");
    restore_pixels(queue_, guides(), pixels_, std::span(state).subspan(DenoiserHead::kWords));
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
    filter_.run();
    queue_.copy_to_host(colors.data(), filter_.color(), pixels_ * sizeof(Float4));
    return with_colors(std::move(picture), colors);
}

} // namespace pertev
