#pragma once

// The traversal laboratory's report as a measurement: tables "scene" (one row), "sets", "structures", and "runs", one
// row for each combination and set of rays. Combinations without figures have a row with the reason. Registers, local
// bytes and occupancy stand in rows of closest-hit sets only, because they are of that kernel.

#include <string>

#include "lab/lab_report.h"
#include "lab/measurement.h"

namespace pertev {

/// Makes the tables of a report. `head` names the machine and the command.
Measurement measurement_of(const LabReport& report, Measurement head = {});

/// Returns text for a terminal: structures, million rays per second by combination and set (fastest first), frames per
/// second by depth, and notes.
std::string text_of(const LabReport& report);

} // namespace pertev
