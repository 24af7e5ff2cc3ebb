#include "apps/cli/parse_values.h"

#include <algorithm>
#include <limits>

#include <fmt/format.h>

#include "base/error.h"
#include "base/limits.h"
#include "formats/files/parse_number.h"

namespace pertev {
namespace {

constexpr float kMaxFloat = std::numeric_limits<float>::max();

/// Each is one that a float can hold.
std::optional<DoubleVec3> three_doubles(std::string_view text) {
    double values[3];
    for (int i = 0; i < 3; ++i) {
        const std::size_t comma = text.find(',');
        if ((comma == std::string_view::npos) != (i == 2)) return std::nullopt;
        const auto value = parse_whole_float<double>(text.substr(0, comma));
        if (!value || !is_finite(static_cast<float>(*value))) return std::nullopt;
        values[i] = *value;
        if (i < 2) text.remove_prefix(comma + 1);
    }
    return DoubleVec3{values[0], values[1], values[2]};
}

std::optional<Vec3> three_numbers(std::string_view text) {
    const std::optional<DoubleVec3> values = three_doubles(text);
    return values ? std::optional(to_float(*values)) : std::nullopt;
}

DoubleVec3 parse_doubles(const std::string& flag, const std::string& text) {
    if (const auto value = three_doubles(text)) return *value;
    throw Error(
        ErrorCode::BadInput,
        fmt::format("{} {}: expected three numbers X,Y,Z of size {} at most, such as 1,0.5,-2", flag, text, kMaxFloat));
}

} // namespace

std::optional<float> number_in(std::string_view text) {
    const std::optional<float> value = parse_whole_float(text);
    return value && is_finite(*value) ? value : std::nullopt;
}

std::pair<uint32_t, uint32_t> parse_size(const std::string& flag, const std::string& text) {
    const std::size_t cross = std::min(text.find('x'), text.size());
    const auto width = parse_whole_number(std::string_view(text).substr(0, cross));
    const auto height = parse_whole_number(std::string_view(text).substr(std::min(cross + 1, text.size())));
    if (!width || !height || *width == 0 || *height == 0) {
        throw Error(ErrorCode::BadInput,
                    fmt::format("{} {}: expected WIDTHxHEIGHT in pixels, such as 1280x720", flag, text));
    }
    if (*width > kMaxImageSide || *height > kMaxImageSide || *width * *height > kMaxImagePixels) {
        throw Error(ErrorCode::OverLimit, fmt::format("{} {}: over the limit of {} pixels a side and {} in all", flag,
                                                      text, kMaxImageSide, kMaxImagePixels));
    }
    return {static_cast<uint32_t>(*width), static_cast<uint32_t>(*height)};
}

float parse_number(const std::string& flag, const std::string& text) {
    if (const auto value = number_in(text)) return *value;
    throw Error(ErrorCode::BadInput, fmt::format("{} {}: expected a number of size {} at most", flag, text, kMaxFloat));
}

Vec3 parse_vec3(const std::string& flag, const std::string& text) { return to_float(parse_doubles(flag, text)); }

DoubleVec3 parse_position(const std::string& flag, const std::string& text) {
    const DoubleVec3 position = parse_doubles(flag, text);
    if (max_component(abs(to_float(position))) <= kMaxCoordinate) return position;
    throw Error(ErrorCode::OverLimit,
                fmt::format("{} {}: farther than the limit of {:.4g} m from the origin", flag, text, kMaxCoordinate));
}

bool parse_rgb(const std::string& text, Rgb& color) {
    const auto value = three_numbers(text);
    if (value) color = {value->x, value->y, value->z};
    return value.has_value();
}

Rgb parse_radiance(const std::string& flag, const std::string& text) {
    Rgb radiance;
    bool is_one = parse_rgb(text, radiance);
    if (const auto value = is_one ? std::nullopt : number_in(text)) {
        radiance = grey(*value);
        is_one = true;
    }
    if (is_one && radiance.r >= 0 && radiance.g >= 0 && radiance.b >= 0) return radiance;
    throw Error(
        ErrorCode::BadInput,
        fmt::format("{} {}: expected a radiance, R,G,B or one number for all three, each at least 0", flag, text));
}

} // namespace pertev
