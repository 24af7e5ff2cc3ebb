#pragma once

// A table of texts as an HTML element.

#include <string>
#include <vector>

namespace pertev {

/// The first row is the head. Rows may be shorter than others.
std::string html_table(const std::vector<std::vector<std::string>>& rows);

} // namespace pertev
