#pragma once

// What the laboratory is asked to measure, before anything is: each combination once, those that cannot be measured
// with the reason.

#include <vector>

#include "lab/run_lab.h"

namespace pertev {

/// In the order in which they are measured; names differ.
std::vector<CombinationFigures> list_combinations(const LabSettings& settings, bool on_cuda);

/// Throws Error(BadInput) with the reasons where all are refused.
void check_any_can_run(const std::vector<CombinationFigures>& combinations);

} // namespace pertev
