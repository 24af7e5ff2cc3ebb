#pragma once

// Tables of plain text, for a terminal.

#include <string>
#include <vector>

namespace pertev {

/// A line a row: the first column to the left, the others to the right, each as wide as its longest cell (in UTF-8
/// characters), two blanks between. Rows may be shorter than others.
std::string align_columns(const std::vector<std::vector<std::string>>& rows);

} // namespace pertev
