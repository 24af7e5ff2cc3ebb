#pragma once

// All expressions of a render as one deterministic automaton, which reads a path from the eye and yields, wherever
// light enters, the layers that take it. With a single automaton a path has one state, whatever the number of layers.
//
// Source: Rabin, Scott, "Finite Automata and Their Decision Problems", IBM Journal 3(2), 1959 (subsets of states).

#include <cstdint>
#include <span>
#include <vector>

#include "render/light_paths/light_path_expression.h"

namespace pertev {

/// Classes of a scene's objects and lights with respect to the name filters. A tag stands for everything that the
/// same filters accept: [tag][filter of all expressions, one expression after the other]. Each kind has at least one
/// tag.
struct LightPathTags {
    std::vector<std::vector<bool>> surfaces, lights;
};

/// Column of a scattering among the six of its surface's tag.
HD inline constexpr uint32_t scattering_column(LobeClass lobe_class, bool is_transmission) {
    return 2 * static_cast<uint32_t>(lobe_class) + (is_transmission ? 1 : 0);
}
inline constexpr uint32_t kScatteringColumns = 6;

struct LightPathAutomaton {
    static constexpr uint16_t kNothing = 0; // a state from which no layer takes any light

    uint16_t start = kNothing;     // state after the eye
    uint32_t column_count = 0;     // number of scatterings that some expression distinguishes
    std::vector<uint16_t> columns; // [surface tag * kScatteringColumns + scattering_column]
    std::vector<uint16_t> next;    // [state * column_count + column]
    uint32_t light_count = 0;      // number of lights that some expression distinguishes
    std::vector<uint16_t> lights;  // [light tag], below light_count
    uint32_t words = 0;            // words per set of layers: 32 layers each, the first in the lowest bit
    std::vector<uint32_t> layers;  // [(state * light_count + light) * words]: sets

    uint32_t state_count() const { return static_cast<uint32_t>(layers.size() / (std::size_t(light_count) * words)); }
    uint16_t next_state(uint16_t state, uint32_t tag, LobeClass lobe_class, bool is_transmission) const {
        const uint16_t column = columns[tag * kScatteringColumns + scattering_column(lobe_class, is_transmission)];
        return next[state * column_count + column];
    }
    std::span<const uint32_t> layers_of(uint16_t state, uint32_t tag) const {
        return std::span(layers).subspan((std::size_t(state) * light_count + lights[tag]) * words, words);
    }
    bool takes(uint16_t state, uint32_t tag, uint32_t layer) const {
        return (layers_of(state, tag)[layer / 32] >> layer % 32 & 1u) != 0;
    }
};

/// Maximum number of states, which keeps the tables small.
inline constexpr uint32_t kMaxLightPathStates = 16384;
/// Maximum number of table entries: states times all inputs.
inline constexpr uint64_t kMaxLightPathEntries = 1u << 24;
/// Maximum number of states of the expressions' separate automata together, and of states that may be visited while
/// they are combined.
inline constexpr uint64_t kMaxLightPathParts = 1u << 22, kMaxLightPathSteps = 1u << 29;

/// Makes the automaton in which layer i belongs to expression i; there is at least one. It has as few states as
/// possible, unless minimization takes more than `max_steps`. Throws Error(OverLimit) beyond one of these limits:
/// expressions that distinguish many pasts of a path may need as many states.
LightPathAutomaton make_automaton(std::span<const LightPathExpression> expressions, const LightPathTags& tags,
                                  uint64_t max_steps = kMaxLightPathSteps);

} // namespace pertev
