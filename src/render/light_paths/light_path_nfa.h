#pragma once

// An expression as a nondeterministic automaton that reads paths backwards, from the eye, in the order of a path
// tracer.
//
// Source: Thompson, "Regular Expression Search Algorithm", CACM 11(6), 1968; sequences are built from their end.

#include <cstdint>
#include <vector>

#include "render/light_paths/light_path_expression.h"

namespace pertev {

struct LightPathNfa {
    static constexpr uint32_t kNone = 0xffffffffu;
    struct State {
        uint32_t letter = kNone;            // index into LightPathExpression::letters, read on the transition to
                                            // `next`
        uint32_t next = kNone;              // target of the letter's transition
        uint32_t empty[2] = {kNone, kNone}; // empty transitions
    };
    std::vector<State> states;
    uint32_t first = 0, last = 0;
};

/// Makes the automaton of an expression. Throws Error(OverLimit) beyond kMaxLightPathLetters.
LightPathNfa make_nfa(const LightPathExpression& expression);

/// Adds all states reachable from `states` by empty transitions; sorted, without duplicates. `seen` is false for each
/// state before and after.
void close_over_empty(const LightPathNfa& nfa, std::vector<uint32_t>& states, std::vector<bool>& seen);

/// Checks an expression. Throws Error(BadInput) if no path of a light, scatterings and the eye matches.
void check_matches_something(const LightPathExpression& expression);

} // namespace pertev
