#pragma once

// A single picture from few samples a pixel, without any frame before: the variance-guided wavelet passes of frames
// (denoise/reconstruction.h), led by what the rays through pixels' centres meet. Samples are added one of each pixel at
// a time, in the order of their numbers, so that the picture of a samples with b added has the bytes of a + b. Every
// stage is one function for both devices. The picture is biased: it blurs light where no guide shows an edge.
//
// Sums are floats: past a hundred thousand samples a pixel they round visibly, long after there is noise to take out.

#include "denoise/gather_samples.h"
#include "device/buffer.h"
#include "image/image.h"
#include "render/noisy_frame.h"

namespace pertev {

class PictureDenoiser {
public:
    static constexpr uint32_t kFeatures = 16;

    PictureDenoiser(Queue& queue, uint32_t width, uint32_t height);

    /// Begins a picture. `centres`: a frame of this size, of rays through the pixels' centres, seen by `camera`.
    void begin(const NoisyFrame& centres, const CameraView& camera);
    /// What the camera rays of a sample meet: of samples 0 to kFeatures - 1 before any light, so that edges and
    /// textures are smooth however few samples there will be. `frame` may be without light.
    void add_features(const NoisyFrame& frame, const SceneView& scene);
    /// The next sample of each pixel.
    void add(const NoisyFrame& frame, const SceneView& scene);
    /// RGB, linear, of the samples added since begin(): at least one.
    Image picture();

    uint32_t width() const { return width_; }
    uint32_t height() const { return height_; }

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
