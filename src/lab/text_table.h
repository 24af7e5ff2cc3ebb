#pragma once

// Plain-text tables for terminals.

#include <string>
#include <vector>

namespace pertev {

/// Returns one line per row. The first column is aligned left, the others right; each is as wide as its longest cell
/// (in UTF-8 characters), with two blanks between columns. Rows may have different lengths.
std::string align_columns(const std::vector<std::vector<std::string>>& rows);

/// Formats with this many decimals, or in two significant digits where fewer would show: 0.00003 is "3e-05", not
/// "0.000".
std::string fixed_text(double value, int decimals);

} // namespace pertev
