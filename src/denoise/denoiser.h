#pragma once

// The seam of a post step that makes a picture of noisy samples. It takes samples one of each pixel at a time, each
// with its colour, albedo and normal (render/noisy_frame.h), and gives a picture of all that it has taken.

#include "device_scene/scene_view.h"
#include "image/image.h"
#include "render/camera_view.h"
#include "render/noisy_frame.h"

namespace pertev {

class Denoiser {
public:
    virtual ~Denoiser() = default;

    /// Begins a picture. `centres` has its size, and shows what rays through the pixels' centres meet; `camera` sees
    /// it.
    virtual void begin(const NoisyFrame& centres, const CameraView& camera) = 0;
    /// Samples of each pixel whose surfaces add_features() is to be given between begin() and the first add().
    virtual uint32_t feature_samples() const = 0;
    /// Adds what the camera rays of a sample meet. `frame` may be without light.
    virtual void add_features(const NoisyFrame& frame, const SceneView& scene) = 0;
    /// Adds the next sample of each pixel.
    virtual void add(const NoisyFrame& frame, const SceneView& scene) = 0;
    /// Returns RGB, linear, of the samples since begin(), of which there is at least one.
    virtual Image picture() = 0;
};

} // namespace pertev
