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

/// "0.0370 ± 0.0012": the uncertainty in two digits, and the value to the same place. Both are finite, the uncertainty
/// at least 0. One of less than 1e-9 of the value, which is a sum's rounding, is shown as 0; the value has three digits
/// then.
std::string uncertain_text(double value, double uncertainty);

} // namespace pertev
