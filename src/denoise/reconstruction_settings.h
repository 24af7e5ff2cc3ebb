#pragma once

// Settings of reconstruction. Each part that changes the mean (is *biased*) has a switch.

#include <algorithm>
#include <cstdint>

namespace pertev {

/// The filter of a frame's light.
enum class FrameDenoiser : uint8_t {
    Svgf, // wavelet passes
    Oidn, // denoise/oidn/oidn_frames.h, after all else and outside the one-picture law
};

struct ReconstructionSettings {
    FrameDenoiser denoiser = FrameDenoiser::Svgf;
    uint32_t history = 32;          // maximum number of frames of a mean, >= 1
    uint32_t passes = 5;            // passes of the wavelet filter, [0, 8]; 0: none, as with Oidn. Biased: blurs what
                                    // guides do not show
    bool clamp_fireflies = true;    // biased: darkens samples far brighter than all their neighbours
    bool clamp_history = true;      // biased: clamps long means to recent frames, against ghosting
    bool temporal_gradients = true; // if the scene moves, updates means by the change of light
                                    // (temporal_gradients_view.h). Biased
    bool anti_alias = true;   // biased: the mean of shown frames is clamped to surrounding colours
    bool keep_layers = false; // for Reconstruction::motion() and deviation(); does not affect the frame

    /// Ratio of the sides of the light's frame and of the picture, (0, 1]. Below 1 camera rays are traced at the
    /// picture's resolution, and light is upsampled by their hits. Biased: light between edges is coarse.
    float resolution_scale = 1;

    bool operator==(const ReconstructionSettings&) const = default;
};

/// Returns `settings` without any filtering, clamping or history, so that the picture shows the raw samples. Reservoirs
/// of ReSTIR still follow the light by temporal gradients.
inline ReconstructionSettings of_samples_alone(ReconstructionSettings settings) {
    settings.denoiser = FrameDenoiser::Svgf;
    settings.history = 1;
    settings.passes = 0;
    settings.clamp_fireflies = settings.clamp_history = settings.anti_alias = false;
    return settings;
}

/// Side of the light's frame in pixels for a picture's side.
inline uint32_t scaled_side(uint32_t side, const ReconstructionSettings& settings) {
    return std::max(static_cast<uint32_t>(static_cast<float>(side) * settings.resolution_scale + 0.5f), 1u);
}

} // namespace pertev
