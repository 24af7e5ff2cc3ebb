#pragma once

// An expression as a nondeterministic automaton that reads paths backwards, from the eye, as a path tracer finds them.
//
// Source: Thompson, "Regular Expression Search Algorithm", CACM 11(6), 1968; sequences are built from their end.

#include <cstdint>
#include <vector>

#include "render/light_paths/light_path_expression.h"

namespace pertev {

struct LightPathNfa {
    static constexpr uint32_t kNone = 0xffffffffu;
    struct State {
        uint32_t letter = kNone;            // index into LightPathExpression::letters: read on the way to `next`
        uint32_t next = kNone;              // where letter is
        uint32_t empty[2] = {kNone, kNone}; // ways that read nothing
    };
    std::vector<State> states;
    uint32_t first = 0, last = 0;
};

/// Throws Error(OverLimit) past kMaxLightPathLetters.
LightPathNfa make_nfa(const LightPathExpression& expression);

/// Adds all states that are reached from those of `states` by reading nothing. Sorted, each once. `seen`: of each state
/// false, before and after.
void close_over_empty(const LightPathNfa& nfa, std::vector<uint32_t>& states, std::vector<bool>& seen);

/// Throws Error(BadInput) where no path matches: a light, scatterings, the eye.
void check_matches_something(const LightPathExpression& expression);

} // namespace pertev
