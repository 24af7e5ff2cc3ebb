#pragma once

// Minimization of the automaton.
//
// Source: Moore, "Gedanken-Experiments on Sequential Machines", 1956.

#include "render/light_paths/light_path_automaton.h"

namespace pertev {

/// Merges states that no path distinguishes; kNothing stays 0. Returns `all` unchanged if that takes more than
/// `max_steps`.
LightPathAutomaton minimise(LightPathAutomaton all, uint64_t max_steps);

} // namespace pertev
