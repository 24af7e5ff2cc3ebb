#pragma once

// Text and numbers as JSON wants them written, and text as every UTF-8 file does.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace pertev {

/// Text as a JSON string, quotes included.
std::string json_string(std::string_view text);
/// A JSON array of strings.
std::string json_strings(const std::vector<std::string>& texts);
/// The text with U+FFFD in place of each byte that is not UTF-8: names of files may be any bytes.
std::string utf8_text(std::string_view text);
/// A number in JSON, to 9 digits; null where it is not finite, which JSON has no word for.
std::string json_number(double value);
/// "1,0.5,-2", as flags have vectors, as a JSON array of these numbers, to all their digits; "1,0,0 0,1,0" as an array
/// of such arrays. Nothing for a text that is anything else.
std::optional<std::string> json_vector(std::string_view text);

} // namespace pertev
