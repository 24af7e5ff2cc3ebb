#include "settings/parse_values.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/limits.h"
#include "formats/files/parse_number.h"

namespace pertev {
namespace {

constexpr float kMaxFloat = std::numeric_limits<float>::max();

std::optional<DoubleVec3> three_doubles(std::string_view text) {
    const auto values = numbers_in(text);
    if (!values || values->size() != 3) return std::nullopt;
    return DoubleVec3{(*values)[0], (*values)[1], (*values)[2]};
}

std::optional<Vec3> three_numbers(std::string_view text) {
    const std::optional<DoubleVec3> values = three_doubles(text);
    return values ? std::optional(to_float(*values)) : std::nullopt;
}

DoubleVec3 parse_doubles(const std::string& setting, const std::string& text) {
    if (const auto value = three_doubles(text)) return *value;
    throw Error(ErrorCode::BadInput, setting, text,
                fmt::format("expected three numbers X,Y,Z between -{0} and {0}, such as 1,0.5,-2", kMaxFloat));
}

/// Returns whether there is a digit other than 0 before the exponent.
bool has_digits(const std::string& number) { return number.find_first_of("123456789") < number.find_first_of("eE"); }

} // namespace

std::string limit_text(double limit) {
    constexpr double kLargestWhole = 0x1p53; // beyond, a double skips whole numbers
    const bool is_whole = -kLargestWhole <= limit && limit <= kLargestWhole && limit == std::trunc(limit);
    return is_whole ? fmt::format("{}", static_cast<int64_t>(limit)) : fmt::format("{}", static_cast<float>(limit));
}

std::string why_no_number(const std::string& text, double low, double high) {
    const auto value = number_in(text);
    const bool is_one = value && *value >= static_cast<float>(low) && *value <= static_cast<float>(high);
    return is_one ? "" : fmt::format("not a number from {} to {}", limit_text(low), limit_text(high));
}

std::string why_not_above(const std::string& text, double low, double high) {
    const auto value = number_in(text);
    if (value && *value > static_cast<float>(low) && *value <= static_cast<float>(high)) return "";
    const bool is_rounded = value && *value == 0 && has_digits(text);
    return fmt::format("not a number above {} and at most {}{}", limit_text(low), limit_text(high),
                       is_rounded ? "; a number so near 0 counts as 0" : "");
}

std::string why_not_whole(const std::string& text, uint32_t low, uint32_t high) {
    const auto value = parse_whole_number(text);
    const bool is_one = value && *value >= low && *value <= high;
    return is_one ? "" : fmt::format("not a whole number from {} to {}", low, high);
}

std::string why_no_choice(const std::string& text, const std::vector<std::string>& choices) {
    const bool is_one = std::ranges::find(choices, text) != choices.end();
    return is_one ? "" : fmt::format("not one of {}", fmt::join(choices, ", "));
}

std::optional<float> number_in(std::string_view text) {
    const std::optional<float> value = parse_whole_float(text);
    return value && is_finite(*value) ? value : std::nullopt;
}

std::optional<std::vector<double>> numbers_in(std::string_view text) {
    std::vector<double> values;
    while (true) {
        const std::size_t comma = std::min(text.find(','), text.size());
        const auto value = parse_whole_float<double>(text.substr(0, comma));
        if (!value || !is_finite(static_cast<float>(*value))) return std::nullopt;
        values.push_back(*value);
        if (comma == text.size()) return values;
        text.remove_prefix(comma + 1);
    }
}

std::pair<uint32_t, uint32_t> parse_size(const std::string& setting, const std::string& text) {
    const std::size_t cross = std::min(text.find('x'), text.size());
    const auto width = parse_whole_number(std::string_view(text).substr(0, cross));
    const auto height = parse_whole_number(std::string_view(text).substr(std::min(cross + 1, text.size())));
    if (!width || !height || *width == 0 || *height == 0) {
        throw Error(ErrorCode::BadInput, setting, text, "expected WIDTHxHEIGHT in pixels, such as 1280x720");
    }
    if (*width > kMaxImageSide || *height > kMaxImageSide || *width * *height > kMaxImagePixels) {
        throw Error(
            ErrorCode::OverLimit, setting, text,
            fmt::format("over the limit of {} pixels per side and {} in total", kMaxImageSide, kMaxImagePixels));
    }
    return {static_cast<uint32_t>(*width), static_cast<uint32_t>(*height)};
}

float parse_number(const std::string& setting, const std::string& text) {
    if (const auto value = number_in(text)) return *value;
    throw Error(ErrorCode::BadInput, setting, text, fmt::format("expected a number between -{0} and {0}", kMaxFloat));
}

Vec3 parse_vec3(const std::string& setting, const std::string& text) { return to_float(parse_doubles(setting, text)); }

DoubleVec3 parse_position(const std::string& setting, const std::string& text) {
    const DoubleVec3 position = parse_doubles(setting, text);
    if (max_component(abs(to_float(position))) <= kMaxCoordinate) return position;
    throw Error(ErrorCode::OverLimit, setting, text,
                fmt::format("beyond the limit of {} m from the origin", limit_text(kMaxCoordinate)));
}

bool parse_rgb(const std::string& text, Rgb& color) {
    const auto value = three_numbers(text);
    if (value) color = {value->x, value->y, value->z};
    return value.has_value();
}

Rgb parse_radiance(const std::string& setting, const std::string& text) {
    Rgb radiance;
    bool is_one = parse_rgb(text, radiance);
    if (const auto value = is_one ? std::nullopt : number_in(text)) {
        radiance = grey(*value);
        is_one = true;
    }
    if (is_one && radiance.r >= 0 && radiance.g >= 0 && radiance.b >= 0) return radiance;
    throw Error(ErrorCode::BadInput, setting, text,
                "expected a radiance, R,G,B or one number for all three, each at least 0");
}

} // namespace pertev
