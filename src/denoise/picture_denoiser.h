#pragma once

// A single picture from few samples a pixel, without any frame before: the variance-guided wavelet passes of frames
// (denoise/reconstruction.h), led by what the rays through pixels' centres meet. Samples are added one of each pixel at
// a time, in the order of their numbers, so that the picture of a samples with b added has the bytes of a + b. Every
// stage is one function for both devices. The picture is biased: it blurs light where no guide shows an edge.
//
// Sums are floats: past a hundred thousand samples a pixel they round visibly, long after there is noise to take out.

#include "denoise/denoiser.h"
#include "denoise/gather_samples.h"
#include "device/buffer.h"

namespace pertev {

class PictureDenoiser final : public Denoiser {
public:
    static constexpr uint32_t kFeatures = 16;

    PictureDenoiser(Queue& queue, uint32_t width, uint32_t height);

    void begin(const NoisyFrame& centres, const CameraView& camera) override;
    /// Takes samples 0 to kFeatures - 1 before any light, so that edges and textures are smooth however few samples
    /// there will be.
    uint32_t feature_samples() const override { return kFeatures; }
    void add_features(const NoisyFrame& frame, const SceneView& scene) override;
    void add(const NoisyFrame& frame, const SceneView& scene) override;
    Image picture() override;

private:
    SampledSurfaces surfaces_of(const NoisyFrame& frame, const SceneView& scene) const;

    Queue* queue_;
    uint32_t width_, height_, samples_ = 0, features_ = 0;
    bool has_gloss_ = false;
    CameraView camera_ = {};
    Buffer<Float4> wide_;
    Buffer<Vec2> squares_;
    Buffer<uint32_t> objects_;
    PictureGuide guide_ = {};
    Float4 *smooth_ = nullptr, *packed_ = nullptr;
    PictureSums sums_ = {};
    SignalsView from_ = {}, to_ = {};
};

} // namespace pertev
