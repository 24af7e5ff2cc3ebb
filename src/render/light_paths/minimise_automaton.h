#pragma once

// The least automaton that says the same.
//
// Source: Moore, "Gedanken-Experiments on Sequential Machines", 1956.

#include "render/light_paths/light_path_automaton.h"

namespace pertev {

/// States are one where no path tells them apart. kNothing stays 0. `all` itself, where that is not known after
/// `most_steps`.
LightPathAutomaton minimise(LightPathAutomaton all, uint64_t most_steps);

} // namespace pertev
