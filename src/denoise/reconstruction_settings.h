#pragma once

// What a reconstructed frame is a function of, beside the samples. Each part that bends the mean (is *biased*) has a
// switch.

#include <cstdint>

namespace pertev {

struct ReconstructionSettings {
    uint32_t history = 32;       // frames of a mean at most, >= 1
    uint32_t passes = 5;         // of the wavelet filter, [0, 8]; 0: none. Biased: blurs what guides do not show
    bool limit_fireflies = true; // biased: darkens what is far brighter than all around it
    bool limit_history = true;   // biased: pulls long means towards recent frames where they disagree, against ghosts
    bool anti_alias = true;      // biased: the mean of shown frames is held within colours around it
    bool keep_layers = false;    // for Reconstruction::motion() and deviation(); the frame stays the same

    bool operator==(const ReconstructionSettings&) const = default;
};

} // namespace pertev
