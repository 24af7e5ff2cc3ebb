#pragma once

// What ReSTIR is asked for. None of it bends the mean of frames from a still camera in a still scene; see
// docs/real_time.md for what `history` does where things move.

#include <cstdint>

namespace pertev {

/// Which light is drawn from reservoirs that pixels share, instead of by each path for itself.
enum class RestirLight : uint8_t {
    Off,
    Direct,  // "di": what lights send to the first surface
    Indirect // "gi": that, and what diffuse surfaces send to the diffuse lobes of the first surface
};

struct RestirSettings {
    RestirLight light = RestirLight::Off;
    uint32_t candidates = 8; // light samples a pixel and frame, [1, 64]
    uint32_t neighbours = 3; // pixels beside that a pixel takes from, [0, 3]
    float radius = 24;       // pixels, within which these are
    uint32_t history = 20;   // frames that the frame before counts for at most; 0: nothing is taken from it. Biased
                             // where light or shadows move: they arrive late

    bool operator==(const RestirSettings&) const = default;
};

} // namespace pertev
