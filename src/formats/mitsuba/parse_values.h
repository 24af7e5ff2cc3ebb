#pragma once

// Values in attributes of Mitsuba's XML.

#include <string_view>
#include <vector>

namespace pertev::mitsuba {

/// Returns the numbers of a text, between which are blanks or commas; none if a word is no number.
std::vector<double> parse_numbers(std::string_view text);

/// Returns the three channels of a linear or sRGB-encoded colour: numbers, one for all channels, or #rrggbb, which is
/// encoded; another count if it is none.
std::vector<double> parse_color(std::string_view text, bool is_encoded);

} // namespace pertev::mitsuba
