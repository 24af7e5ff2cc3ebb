#pragma once

// All expressions of a render as one deterministic automaton, which reads a path from the eye and says of each place
// where light comes in which layers take it. One, and not one each: a path then has one state, whatever the number of
// layers.
//
// Source: Rabin, Scott, "Finite Automata and Their Decision Problems", IBM Journal 3(2), 1959 (subsets of states).

#include <cstdint>
#include <span>
#include <vector>

#include "render/light_paths/light_path_expression.h"

namespace pertev {

/// What names and filters have to do with each other in a scene. A tag stands for all things that the same filters let
/// through: [tag][filter of all expressions, one expression's after the other's]. At least one tag each.
struct LightPathTags {
    std::vector<std::vector<bool>> surfaces, lights;
};

/// The column of a scattering among the six of its surface's tag.
HD inline constexpr uint32_t scattering_column(LobeClass lobe_class, bool is_transmission) {
    return 2 * static_cast<uint32_t>(lobe_class) + (is_transmission ? 1 : 0);
}
inline constexpr uint32_t kScatteringColumns = 6;

struct LightPathAutomaton {
    static constexpr uint16_t kNothing = 0; // a state from which no layer takes any light

    uint16_t start = kNothing;     // after the eye
    uint32_t column_count = 0;     // scatterings that differ to some expression
    std::vector<uint16_t> columns; // [surface tag * kScatteringColumns + scattering_column]
    std::vector<uint16_t> next;    // [state * column_count + column]
    uint32_t light_count = 0;      // lights that differ
    std::vector<uint16_t> lights;  // [light tag], of light_count
    uint32_t words = 0;            // of a set of layers: 32 of them each, the first in the lowest bit of the first
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

/// States of an automaton: their tables stay small.
inline constexpr uint32_t kMaxLightPathStates = 16384;
/// Entries of its tables: states times all that a path may do in one.
inline constexpr uint64_t kMaxLightPathEntries = 1u << 24;
/// States of the expressions' own automata, together, and how many of them may be read while they become one.
inline constexpr uint64_t kMaxLightPathParts = 1u << 22, kMaxLightPathSteps = 1u << 29;

/// Layer i is that of expression i; one at least. It has as few states as possible, unless finding which takes more
/// than `most_steps`. Throws Error(OverLimit) past one of these limits: expressions that tell many pasts of a path
/// apart may need as many states as there are pasts.
LightPathAutomaton make_automaton(std::span<const LightPathExpression> expressions, const LightPathTags& tags,
                                  uint64_t most_steps = kMaxLightPathSteps);

} // namespace pertev
