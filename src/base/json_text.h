#pragma once

// Text and numbers as JSON wants them written.

#include <string>
#include <string_view>

namespace pertev {

/// Text as a JSON string, quotes included.
std::string json_string(std::string_view text);
/// A number in JSON, to 9 digits; null where it is not finite, which JSON has no word for.
std::string json_number(double value);

} // namespace pertev
