#pragma once

// A line of a CSV file (RFC 4180, but for the end of a line).

#include <string>
#include <vector>

namespace pertev {

using CsvCells = std::vector<std::string>;

/// With commas between, text in quotes where it needs them, and a line feed behind.
std::string csv_line(const CsvCells& cells);

} // namespace pertev
