#pragma once

// Tables of plain text, for a terminal.

#include <string>
#include <vector>

namespace pertev {

/// A line a row: the first column to the left, the others to the right, each as wide as its longest cell (in UTF-8
/// characters), two blanks between. Rows may be shorter than others.
std::string align_columns(const std::vector<std::vector<std::string>>& rows);

/// With so many decimals; in two digits where these would show fewer: 0.00003 is "3e-05" and not "0.000".
std::string fixed_text(double value, int decimals);

} // namespace pertev
