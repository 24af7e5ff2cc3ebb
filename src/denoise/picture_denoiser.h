#pragma once

// Denoises a single picture with few samples per pixel, without previous frames: the variance-guided wavelet passes
// of frames (denoise/reconstruction.h), guided by the hits of rays through pixels' centres. The first samples' hits,
// which every part of a picture has, decide which surfaces a pixel distinguishes. All else is added exactly
// (denoise/exact_sums.h), so the parts' order does not affect the result. Every stage is one function for both devices.
// The picture is biased: it blurs light where no guide shows an edge, less the less noise there is (fade_filter.h).

#include "denoise/denoiser.h"
#include "denoise/gather_samples.h"
#include "denoise/picture_history.h"
#include "device/buffer.h"

namespace pertev {

class PictureDenoiser final : public Denoiser {
public:
    static constexpr uint32_t kFeatures = 16;

    PictureDenoiser(Queue& queue, uint32_t width, uint32_t height);
    /// Makes a denoiser of frames, each with `samples` samples, whose light is a mean over at most `frames` of them.
    PictureDenoiser(Queue& queue, uint32_t width, uint32_t height, uint32_t samples, uint32_t frames);

    void begin(const NoisyFrame& centres, const CameraView& camera, const PixelWindow& window) override;
    /// Returns kFeatures: the surfaces of samples 0 to kFeatures - 1 are required, so that edges and textures are
    /// smooth even with few samples. Later ones are features too.
    uint32_t feature_samples() const override { return kFeatures; }
    void add_features(const NoisyFrame& frame, const SceneView& scene) override;
    MirrorChainView mirrors() const override { return chain_; }
    void guide_mirrors(const NoisyFrame& frame) override;
    bool has_mirrors() const override { return has_mirrors_; }
    void add_mirrors(const NoisyFrame& frame, const SceneView& scene) override;
    void add(const NoisyFrame& frame, const SceneView& scene, uint32_t sample) override;
    PictureHistory* history() override { return history_ ? &*history_ : nullptr; }
    void follow(const NoisyFrame& centres, const SceneView& scene, const PreviousScene& before) override;
    void forget_samples() override;
    DenoiserState state() const override;
    void restore(const DenoiserState& state) override;
    static constexpr DenoiserStateSize state_size(std::size_t pixels) {
        const std::size_t sums = 2 * SampleSums::kArrays * pixels;
        return {DenoiserHead::kWords + pixels * kPixelWords + sums, sums};
    }
    /// Replaces the colours by those of the samples that the denoiser has gathered, so it can only be the first step.
    Image apply(Image picture) override;

private:
    static constexpr std::size_t kOfMirrors = MirrorSums::kArrays * MirrorSums::kBranches + 1; // arrays of Float4
    // Words of a pixel in a state, without the sums: the light of mirrors' branches is one of these.
    static constexpr std::size_t kPixelWords =
        4 * (6 + 2 * kNeighbourSurfaces + kOfMirrors - MirrorSums::kBranches) + 1;

    std::vector<PixelWords> gathered() const;
    void filter_mirrors(SignalsView other);
    SampledSurfaces surfaces_of(const NoisyFrame& frame, const SceneView& scene) const;

    Queue* queue_;
    uint32_t width_, height_, samples_ = 0, features_ = 0;
    bool has_gloss_ = false, has_mirrors_ = false;
    CameraView camera_ = {};
    PixelWindow window_;
    Buffer<Float4> wide_;
    Buffer<int64_t> exact_;
    Buffer<Vec2> squares_;
    Buffer<float> noise_;
    Buffer<uint32_t> objects_;
    PictureGuide guide_ = {};
    Float4 *smooth_ = nullptr, *packed_ = nullptr;
    PictureSums sums_ = {};
    SignalsView from_ = {}, to_ = {}, mirrored_ = {};
    MirrorSums mirrors_ = {};
    MirrorChainView chain_ = {};
    std::optional<PictureHistory> history_; // none: pictures are independent

    MirrorSums mirrors_if_gloss() const { return has_gloss_ && has_mirrors_ ? mirrors_ : MirrorSums{}; }
};

} // namespace pertev
