#pragma once

// The tables of the HTML report, each an HTML element or nothing where it would be empty.

#include <string>

#include "lab/lab_report.h"

namespace pertev {

/// A red paragraph that names the combinations that differ from the proven walk.
std::string html_wrong(const LabReport& report);
/// And below them, what was asked for and is not there.
std::string html_sets(const LabReport& report);
std::string html_structures(const LabReport& report);
/// Structures down, walks across, with all switches on and one ray a thread: million rays a second, a table a set.
std::string html_matrices(const LabReport& report);
/// What each switch brings: tables of ratios, wherever both sides were measured.
std::string html_ratios(const LabReport& report);
/// A line a combination and set.
std::string html_figures(const LabReport& report);
/// Refused combinations by reason; wrong ones are not among them.
std::string html_not_run(const LabReport& report);

} // namespace pertev
