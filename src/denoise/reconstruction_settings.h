#pragma once

// What a reconstructed frame is a function of, beside the samples. Each part that bends the mean (is *biased*) has a
// switch.

#include <algorithm>
#include <cstdint>

namespace pertev {

struct ReconstructionSettings {
    uint32_t history = 32;       // frames of a mean at most, >= 1
    uint32_t passes = 5;         // of the wavelet filter, [0, 8]; 0: none. Biased: blurs what guides do not show
    bool limit_fireflies = true; // biased: darkens what is far brighter than all around it
    bool limit_history = true;   // biased: pulls long means towards recent frames where they disagree, against ghosts
    bool follow_light = true;    // where the scene moves: means are changed as light has (light_change_view.h). Biased
    bool anti_alias = true;      // biased: the mean of shown frames is held within colours around it
    bool keep_layers = false;    // for Reconstruction::motion() and deviation(); the frame stays the same

    /// Sides of the frame that light is found at, over those of the picture, (0, 1]. Under 1 camera rays are traced at
    /// the picture's resolution, and light is enlarged by what they meet. Biased: light between edges is coarse.
    float resolution_scale = 1;

    bool operator==(const ReconstructionSettings&) const = default;
};

/// As `settings`, but the picture is that of the frame's samples alone: nothing is filtered, held or taken from others.
inline ReconstructionSettings of_samples_alone(ReconstructionSettings settings) {
    settings.history = 1;
    settings.passes = 0;
    settings.limit_fireflies = settings.limit_history = settings.follow_light = settings.anti_alias = false;
    return settings;
}

/// Pixels of a side of the frame that light is found at, of a picture's side.
inline uint32_t scaled_side(uint32_t side, const ReconstructionSettings& settings) {
    return std::max(static_cast<uint32_t>(static_cast<float>(side) * settings.resolution_scale + 0.5f), 1u);
}

} // namespace pertev
