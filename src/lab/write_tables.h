#pragma once

// The report as tables: CSV, one line a combination and set; JSON, everything but the pictures; plain text for a
// terminal.

#include <string>

#include "lab/lab_report.h"

namespace pertev {

/// Comma-separated, with a header line; text in quotes where it needs them (RFC 4180). Refused combinations are in it,
/// with their reason.
std::string csv_of(const LabReport& report);

/// One JSON object.
std::string json_of(const LabReport& report);

/// For a terminal: structures, then a line a combination with million rays a second of each set, the fastest first.
std::string text_of(const LabReport& report);

} // namespace pertev
