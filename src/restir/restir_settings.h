#pragma once

// Settings of ReSTIR. None of them biases the mean of frames of a still camera in a static scene; see
// docs/real_time.md for the effect of `history` when things move.

#include <cstdint>

namespace pertev {

/// The light that is drawn from shared reservoirs instead of separately by each path.
enum class RestirLight : uint8_t {
    Off,
    Direct,  // "di": direct light at the first surface
    Indirect // "gi": also light from diffuse surfaces to the diffuse lobes of the first surface
};

struct RestirSettings {
    RestirLight light = RestirLight::Off;
    uint32_t candidates = 8; // light samples per pixel and frame, [1, 64]
    uint32_t neighbours = 3; // spatial neighbours per pixel, [0, 3]
    float radius = 24;       // maximum distance of neighbours, pixels
    uint32_t history = 20;   // maximum confidence of the previous frame, in frames; 0: no temporal reuse. Biased if
                             // light or shadows move, because they arrive late

    bool operator==(const RestirSettings&) const = default;
};

} // namespace pertev
