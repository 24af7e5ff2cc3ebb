#pragma once

// Interface of a post step that makes a picture from noisy samples. It gets one sample per pixel at a time, with
// colour, albedo and normal (render/noisy_frame.h), and returns a picture of all of them.

#include "device_scene/scene_view.h"
#include "image/image.h"
#include "render/camera_view.h"
#include "render/noisy_frame.h"

namespace pertev {

class Denoiser {
public:
    virtual ~Denoiser() = default;

    /// Begins a picture. `centres` has its size, and contains the hits of rays through the pixels' centres; `camera`
    /// is their camera.
    virtual void begin(const NoisyFrame& centres, const CameraView& camera) = 0;
    /// Number of samples per pixel whose surfaces must be passed to add_features() between begin() and the first
    /// add().
    virtual uint32_t feature_samples() const = 0;
    /// Adds the hits of a sample's camera rays. `frame` may have no light.
    virtual void add_features(const NoisyFrame& frame, const SceneView& scene) = 0;
    /// Adds the next sample of each pixel, with light.
    virtual void add(const NoisyFrame& frame, const SceneView& scene) = 0;
    /// Returns RGB, linear, of the samples since begin(), of which there is at least one.
    virtual Image picture() = 0;
};

} // namespace pertev
