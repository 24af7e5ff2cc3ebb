#pragma once

// The pictures of the HTML report: bars a set, curves over the depth of paths, heat maps.

#include <string>

#include "lab/lab_report.h"

namespace pertev {

/// The fastest combinations of each set, by family of walks; copies are left out.
std::string html_bars(const LabReport& report);
/// Of the ten fastest with exact tests; nothing where there is but one depth.
std::string html_curves(const LabReport& report);
/// Those that the report has, all on one scale.
std::string html_heat_maps(const LabReport& report);

} // namespace pertev
