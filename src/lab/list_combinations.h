#pragma once

// Lists the combinations that the laboratory is to measure, each once. Combinations that cannot be measured
// carry the reason.

#include <vector>

#include "lab/run_lab.h"

namespace pertev {

/// Lists combinations in measuring order; their names are unique.
std::vector<CombinationFigures> list_combinations(const LabSettings& settings, bool on_cuda);

/// Throws Error(BadInput) with the reasons if every combination is refused.
void check_any_can_run(const std::vector<CombinationFigures>& combinations);

} // namespace pertev
