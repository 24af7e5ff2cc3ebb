#pragma once

// Denoises a single picture by Open Image Denoise in high quality. Guides are means over the hits of all samples, and
// at least sixteen, so that edges and textures are smooth. The first sixteen are those of every part of the picture;
// later ones are added exactly, so that parts of samples have the guides of one run.

#include "denoise/denoiser.h"
#include "denoise/oidn/oidn_filter.h"
#include "denoise/oidn/oidn_stages.h"
#include "device/buffer.h"

namespace pertev {

class OidnDenoiser final : public Denoiser {
public:
    static constexpr uint32_t kFeatures = 16;

    OidnDenoiser(Queue& queue, uint32_t width, uint32_t height)
        : queue_(queue), filter_(queue, width, height, OidnQuality::High, "denoise"), pixels_(width * height),
          first_(queue, std::size_t(2) * pixels_, "guides of the denoiser"),
          sums_(queue, std::size_t(OidnSums::kArrays) * pixels_, "guides of the denoiser") {}

    void begin(const NoisyFrame&, const CameraView&, const PixelWindow& window) override {
        window_ = window;
        features_ = 0;
        forget_samples();
    }
    void forget_samples() override {
        samples_ = 0;
        sums_.zero();
    }
    uint32_t feature_samples() const override { return kFeatures; }
    void add_features(const NoisyFrame& frame, const SceneView& scene) override;
    void add(const NoisyFrame& frame, const SceneView& scene, uint32_t sample) override;
    DenoiserState state() const override;
    void restore(const DenoiserState& state) override;
    static constexpr DenoiserStateSize state_size(std::size_t pixels) {
        const std::size_t sums = 2 * OidnSums::kArrays * pixels;
        return {DenoiserHead::kWords + 8 * pixels + sums, sums};
    }
    Image apply(Image picture) override;
    std::string name() const override { return filter_.name(); }

private:
    std::vector<PixelWords> gathered() const;
    ExactSums sums() const { return {sums_.data(), pixels_}; }

    Queue& queue_;
    OidnFilter filter_;
    uint32_t pixels_, samples_ = 0, features_ = 0;
    PixelWindow window_;
    Buffer<Float4> first_; // means of the first samples: albedo, normal
    Buffer<int64_t> sums_; // sums of the others
};

} // namespace pertev
