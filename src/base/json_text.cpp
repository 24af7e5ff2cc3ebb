#include "base/json_text.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

namespace pertev {
namespace {

/// Number of bytes of the UTF-8 character at the start of `text`; 0 if it is invalid. (RFC 3629, section 4.)
std::size_t utf8_length(std::string_view text) {
    const auto at = [&](std::size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u; };
    const unsigned first = at(0);
    const std::size_t length = first < 0x80   ? 1
                               : first < 0xc2 ? 0
                               : first < 0xe0 ? 2
                               : first < 0xf0 ? 3
                               : first < 0xf5 ? 4
                                              : 0;
    for (std::size_t i = 1; i < length; ++i) {
        if ((at(i) & 0xc0) != 0x80) return 0;
    }
    const bool bad_second = (first == 0xe0 && at(1) < 0xa0) || (first == 0xed && at(1) > 0x9f) ||
                            (first == 0xf0 && at(1) < 0x90) || (first == 0xf4 && at(1) > 0x8f);
    return bad_second ? 0 : length;
}

/// Converts the parts of `text` between separators by `json_of` to an array; nothing if `json_of` returns nothing for a
/// part.
template <class JsonOf>
std::optional<std::string> json_array(std::string_view text, char separator, const JsonOf& json_of) {
    std::string list;
    while (true) {
        const std::size_t end = std::min(text.find(separator), text.size());
        const std::optional<std::string> part = json_of(text.substr(0, end));
        if (!part) return std::nullopt;
        list += (list.empty() ? "" : ",") + *part;
        if (end == text.size()) return "[" + list + "]";
        text.remove_prefix(end + 1);
    }
}

/// Returns whether a nonzero number outside the range of doubles is too small rather than too large.
bool is_too_small(std::string_view text) {
    const std::size_t e = text.find_first_of("eE");
    return e == std::string_view::npos ? text.find('.') < 3 : text.substr(e + 1).starts_with('-');
}

std::optional<std::string> exact_number(std::string_view text) {
    double value = 0;
    const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), value);
    const bool is_zero = fault == std::errc::result_out_of_range && is_too_small(text); // when rounded to a double
    if ((fault != std::errc() && !is_zero) || !std::isfinite(value)) return std::nullopt;
    if (end != text.data() + text.size()) return std::nullopt;
    return value == 0 && std::signbit(value) ? "-0.0" : fmt::format("{}", value); // "-0" would be read as 0
}

std::optional<std::string> numbers_between_commas(std::string_view text) {
    if (text.find(',') == std::string_view::npos) return std::nullopt;
    return json_array(text, ',', exact_number);
}

} // namespace

std::string json_string(std::string_view text) {
    std::string out = "\"";
    while (!text.empty()) {
        const std::size_t length = utf8_length(text);
        const auto byte = static_cast<unsigned char>(text.front());
        if (length == 0) {
            out += "\\ufffd"; // file names may contain any bytes
        } else if (byte < 0x20) {
            out += fmt::format("\\u{:04x}", byte);
        } else {
            if (byte == '"' || byte == '\\') out += '\\';
            out += text.substr(0, length);
        }
        text.remove_prefix(std::max<std::size_t>(length, 1));
    }
    return out + '"';
}

std::string utf8_text(std::string_view text) {
    std::string out;
    while (!text.empty()) {
        const std::size_t length = utf8_length(text);
        out += length == 0 ? "\xef\xbf\xbd" : text.substr(0, length);
        text.remove_prefix(std::max<std::size_t>(length, 1));
    }
    return out;
}

std::string json_number(double number) { return std::isfinite(number) ? fmt::format("{:.9g}", number) : "null"; }

std::string json_strings(const std::vector<std::string>& texts) {
    std::string list = "[";
    for (const std::string& text : texts) list += (list.size() > 1 ? "," : "") + json_string(text);
    return list + ']';
}

std::optional<std::string> json_vector(std::string_view text) {
    if (text.find(' ') == std::string_view::npos) return numbers_between_commas(text);
    return json_array(text, ' ', numbers_between_commas);
}

} // namespace pertev
