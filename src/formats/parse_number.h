#pragma once

// Decimal text to float for the text formats: correctly rounded (std::from_chars), so the same on every machine and in
// every locale. What a float cannot hold becomes an infinity or zero, as IEEE 754 rounds it.

#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <string_view>

namespace pertev {

/// The number at the start of `text`, which is cut behind it; nothing when there is none. Takes a leading +, and `nan`
/// and `inf` in any case.
inline std::optional<float> parse_float(std::string_view& text) {
    const char* begin = text.data();
    const char* end = begin + text.size();
    if (begin != end && *begin == '+') ++begin;
    float value = 0;
    auto [after, fault] = std::from_chars(begin, end, value);
    if (fault == std::errc::result_out_of_range) {
        double wide = 0;
        if (std::from_chars(begin, end, wide).ec == std::errc{}) {
            value = static_cast<float>(wide);
        } else { // outside double as well: the exponent's sign tells which way
            const std::string_view number(begin, static_cast<std::size_t>(after - begin));
            const std::size_t exponent = number.find_first_of("eE");
            const bool is_tiny = exponent != number.npos ? number.substr(exponent).find('-') != number.npos
                                                         : number.find_first_of("123456789") > number.find('.');
            value = is_tiny ? 0.0f : std::numeric_limits<float>::infinity();
            if (number.starts_with('-')) value = -value;
        }
    } else if (fault != std::errc{}) {
        return std::nullopt;
    }
    text.remove_prefix(static_cast<std::size_t>(after - text.data()));
    return value;
}

} // namespace pertev
