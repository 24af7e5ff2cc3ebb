#pragma once

// Parses decimal text in file formats and user input, by std::from_chars, so that it is the same on every machine and
// in every locale. Floats are correctly rounded; a value outside the range of floats becomes an infinity or zero, as
// IEEE 754 rounds it.

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <limits>
#include <optional>
#include <string_view>

namespace pertev {

/// Returns whether the absolute value of a nonzero number is below 1, from the position of its first nonzero digit.
inline bool is_under_one(std::string_view number) {
    const std::size_t end = std::min(number.find_first_of("eE"), number.size());
    const std::string_view digits = number.substr(0, end);
    const auto point = static_cast<int64_t>(std::min(digits.find('.'), digits.size()));
    const auto first = static_cast<int64_t>(digits.find_first_of("123456789"));
    const int64_t magnitude = first < point ? point - first - 1 : point - first;
    std::string_view power = number.substr(std::min(end + 1, number.size()));
    if (power.starts_with('+')) power.remove_prefix(1);
    int64_t exponent = 0;
    const auto read = std::from_chars(power.data(), power.data() + power.size(), exponent);
    if (read.ec == std::errc::result_out_of_range) return power.starts_with('-');
    return exponent < -magnitude;
}

/// Parses the number at the start of `text` and removes it; nothing if there is none. Accepts a leading +, and `nan`
/// and `inf` in any case.
template <class Float = float>
std::optional<Float> parse_float(std::string_view& text) {
    const char* begin = text.data();
    const char* end = begin + text.size();
    if (begin != end && *begin == '+') ++begin;
    Float value = 0;
    auto [after, fault] = std::from_chars(begin, end, value);
    if (fault == std::errc::result_out_of_range) { // the library does not say in which direction
        const std::string_view number(begin, static_cast<std::size_t>(after - begin));
        value = is_under_one(number) ? Float(0) : std::numeric_limits<Float>::infinity();
        if (number.starts_with('-')) value = -value;
    } else if (fault != std::errc{}) {
        return std::nullopt;
    }
    text.remove_prefix(static_cast<std::size_t>(after - text.data()));
    return value;
}

/// Parses the whole of `text` as a number without a leading +.
template <class Float = float>
std::optional<Float> parse_whole_float(std::string_view text) {
    if (text.starts_with('+')) return std::nullopt;
    const std::optional<Float> value = parse_float<Float>(text);
    return text.empty() ? value : std::nullopt;
}

/// Parses the whole of `text` as decimal digits; nothing if `Unsigned` cannot hold the number.
template <class Unsigned = uint64_t>
std::optional<Unsigned> parse_whole_number(std::string_view text) {
    Unsigned value = 0;
    const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (fault != std::errc() || end != text.data() + text.size()) return std::nullopt;
    return value;
}

} // namespace pertev
