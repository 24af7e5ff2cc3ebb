#pragma once

// Denoises a single picture by Open Image Denoise in high quality. Guides are means over the hits of all samples, and
// at least sixteen, so that edges and textures are smooth.

#include "denoise/denoiser.h"
#include "denoise/oidn/oidn_filter.h"

namespace pertev {

class OidnDenoiser final : public Denoiser {
public:
    static constexpr uint32_t kFeatures = 16;

    OidnDenoiser(Queue& queue, uint32_t width, uint32_t height)
        : queue_(queue), filter_(queue, width, height, OidnQuality::High, "denoise"), pixels_(width * height) {}

    void begin(const NoisyFrame&, const CameraView&, const PixelWindow& window) override {
        window_ = window;
        samples_ = features_ = 0;
    }
    uint32_t feature_samples() const override { return kFeatures; }
    void add_features(const NoisyFrame& frame, const SceneView& scene) override;
    void add(const NoisyFrame& frame, const SceneView& scene) override;
    DenoiserState state() const override;
    void restore(const DenoiserState& state) override;
    static constexpr std::size_t state_words(std::size_t pixels) { return DenoiserHead::kWords + 8 * pixels; }
    Image apply(Image picture) override;
    std::string name() const override { return filter_.name(); }

private:
    std::array<PixelWords, 2> guides() const { return {{{filter_.albedo(), 4}, {filter_.normal(), 4}}}; }

    Queue& queue_;
    OidnFilter filter_;
    uint32_t pixels_, samples_ = 0, features_ = 0;
    PixelWindow window_;
};

} // namespace pertev
