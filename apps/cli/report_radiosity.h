#pragma once

// Reports of solving radiosity, for pertev solve and for pictures.

#include "apps/cli/reporter.h"
#include "session/pictures/solve_scene.h"

namespace pertev {

/// Reports the expected memory, each step and the result, and listens for Ctrl-C from the beginning on. `reporter`
/// outlives it.
SolveReport report_solving(Reporter& reporter);

} // namespace pertev
