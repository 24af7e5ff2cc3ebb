#pragma once

// Interface of a post step, which may use the samples of a picture. It gets one sample per pixel at a time, with
// colour, albedo and normal (render/noisy_frame.h), and then the picture of all of them.

#include <memory>
#include <span>
#include <string>
#include <utility>

#include "denoise/denoiser_state.h"
#include "device/launch.h"
#include "device_scene/scene_view.h"
#include "image/image.h"
#include "math/float4.h"
#include "render/camera_view.h"
#include "render/noisy_frame.h"
#include "render/pixel_window.h"
#include "render/reproject.h"

namespace pertev {

class PictureHistory; // denoise/picture_history.h

class Denoiser {
public:
    virtual ~Denoiser() = default;

    /// Begins a picture. `centres` has its size, and contains the hits of rays through the pixels' centres; `camera`
    /// is their camera. Samples will have the pixels of `window` alone, which are whole rows.
    virtual void begin(const NoisyFrame& centres, const CameraView& camera, const PixelWindow& window) = 0;
    /// Number of samples per pixel whose surfaces must be passed to add_features() between begin() and the first
    /// add(). If there are no mirrors to guide, they may also come one by one, each before the light of that sample.
    virtual uint32_t feature_samples() const = 0;
    /// Adds the hits of a sample's camera rays. `frame` may have no light.
    virtual void add_features(const NoisyFrame& frame, const SceneView& scene) = 0;
    /// Returns the arrays in which frames store mirrors (render/mirror_chain_view.h); empty if the denoiser does not
    /// need them.
    virtual MirrorChainView mirrors() const { return {}; }
    /// Adds the mirrors of the rays that begin() got, or of a sample's camera rays after add_features(), with the lobe
    /// that the frame's view states. Each of the two functions is called for the lobe 0 and then for the largest number
    /// below 1.
    virtual void guide_mirrors(const NoisyFrame&) {}
    /// Returns whether guide_mirrors() has got any. If not, frames need not store mirrors, nor need they be added.
    virtual bool has_mirrors() const { return false; }
    virtual void add_mirrors(const NoisyFrame&, const SceneView&) {}
    /// Returns the light of earlier frames, if the denoiser has that of frames of a sequence; else null.
    virtual PictureHistory* history() { return nullptr; }
    /// Lets the picture, whose begin() got `centres`, go on with the history that there is; else the caller cuts that.
    /// `before` is where the scene was in the frame that left it.
    virtual void follow(const NoisyFrame&, const SceneView&, const PreviousScene&) { PERTEV_CHECK(false); }
    /// Adds the next sample of each pixel, with light; `sample` is its number.
    virtual void add(const NoisyFrame& frame, const SceneView& scene, uint32_t sample) = 0;
    /// Returns what the denoiser has gathered of the window's pixels; other pixels are missing.
    virtual DenoiserState state() const = 0;
    /// Forgets the samples since begin(), and keeps the features. Only states with sums (DenoiserStateSize) can.
    virtual void forget_samples() { PERTEV_CHECK(false); }
    /// Replaces what the denoiser has gathered of all pixels by the state of denoisers of the same picture and kind.
    /// Their windows may have been others, and so may their samples if the state has sums (DenoiserStateSize). Throws
    /// Error(BadInput) for words that are no state of this denoiser.
    virtual void restore(const DenoiserState& state) = 0;
    /// Returns `picture`, linear RGB or RGBA, after this step; alpha stays. `picture` has the samples since begin(), of
    /// which there is at least one, after the steps before this one.
    virtual Image apply(Image picture) = 0;
    /// Names the library and device that make the picture, if it is outside the one-picture law; else empty.
    virtual std::string name() const { return {}; }
};

/// Launches a stage for each pixel of a window.
template <class Stage>
void launch_in(Queue& queue, const char* name, const PixelWindow& window, const Stage& stage) {
    if (window.picture_width == 0) return launch(queue, name, window.count(), stage);
    launch(queue, name, window.count(), InWindow<Stage>{stage, window});
}

/// Returns `image` with these colours of its pixels; alpha stays.
inline Image with_colors(Image image, std::span<const Float4> colors) {
    float* to = image.pixels.data();
    for (const Float4& color : colors) {
        to[0] = color.x, to[1] = color.y, to[2] = color.z;
        to += image.channels;
    }
    return image;
}

/// Returns `picture` after all steps: each works on the result of the one before.
inline Image apply_steps(std::span<const std::unique_ptr<Denoiser>> steps, Image picture) {
    for (const auto& step : steps) picture = step->apply(std::move(picture));
    return picture;
}

} // namespace pertev
