#pragma once

// Text and numbers in JSON syntax, and text in valid UTF-8.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace pertev {

/// Text as a JSON string, quotes included.
std::string json_string(std::string_view text);
/// A JSON array of strings.
std::string json_strings(const std::vector<std::string>& texts);
/// The text with U+FFFD in place of each byte that is not UTF-8, because names of files may contain any bytes.
std::string utf8_text(std::string_view text);
/// A number in JSON with 9 digits; null if it is not finite, which JSON cannot represent.
std::string json_number(double value);
/// Converts a vector in the syntax of flags, "1,0.5,-2", to a JSON array with all digits, and "1,0,0 0,1,0" to an
/// array of such arrays. Returns nothing for any other text.
std::optional<std::string> json_vector(std::string_view text);

} // namespace pertev
