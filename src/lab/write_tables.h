#pragma once

// The report as tables: CSV, one line a combination and set; JSON, everything but the pictures; plain text for a
// terminal. What was not measured is empty in the CSV and null in JSON; a 0 there is a figure.

#include <string>

#include "lab/lab_report.h"

namespace pertev {

/// Comma-separated, with a header line; text in quotes where it needs them (RFC 4180). Refused combinations are in it,
/// with their reason. Registers, local bytes and occupancy stand in lines of closest-hit sets alone: they are of that
/// kernel.
std::string csv_of(const LabReport& report);

/// One JSON object. A combination's "structure" is the name of one in "structures".
std::string json_of(const LabReport& report);

/// For a terminal: wrong combinations, structures, then a line a combination with million rays a second of each set,
/// the fastest first; frames a second by depth; on a GPU what warps make of it.
std::string text_of(const LabReport& report);

} // namespace pertev
