#include "apps/cli/parse_values.h"

#include <charconv>
#include <optional>
#include <string_view>

#include <fmt/format.h>

#include "base/error.h"
#include "base/limits.h"

namespace pertev {
namespace {

template <class T>
std::optional<T> parse_whole(std::string_view text) {
    T value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
    return value;
}

std::optional<Vec3> three_numbers(std::string_view text) {
    float values[3];
    for (int i = 0; i < 3; ++i) {
        const std::size_t comma = text.find(',');
        if ((comma == std::string_view::npos) != (i == 2)) return std::nullopt;
        const auto value = parse_whole<float>(text.substr(0, comma));
        if (!value || !is_finite(*value)) return std::nullopt;
        values[i] = *value;
        if (i < 2) text.remove_prefix(comma + 1);
    }
    return Vec3{values[0], values[1], values[2]};
}

} // namespace

std::pair<uint32_t, uint32_t> parse_size(const std::string& flag, const std::string& text) {
    const std::size_t cross = text.find('x');
    if (cross != std::string::npos) {
        const auto width = parse_whole<uint32_t>(std::string_view(text).substr(0, cross));
        const auto height = parse_whole<uint32_t>(std::string_view(text).substr(cross + 1));
        if (width && height && *width > 0 && *height > 0 && *width <= kMaxImageSide && *height <= kMaxImageSide) {
            if (uint64_t(*width) * *height <= kMaxImagePixels) return {*width, *height};
            throw Error(ErrorCode::OverLimit,
                        fmt::format("{} {}: more than the limit of {} pixels", flag, text, kMaxImagePixels));
        }
    }
    throw Error(ErrorCode::BadInput, fmt::format("{} {}: expected WIDTHxHEIGHT, such as 1280x720, each from 1 to {}",
                                                 flag, text, kMaxImageSide));
}

float parse_number(const std::string& flag, const std::string& text) {
    const auto value = parse_whole<float>(text);
    if (value && is_finite(*value)) return *value;
    throw Error(ErrorCode::BadInput, fmt::format("{} {}: expected a number", flag, text));
}

Vec3 parse_vec3(const std::string& flag, const std::string& text) {
    if (const auto value = three_numbers(text)) return *value;
    throw Error(ErrorCode::BadInput, fmt::format("{} {}: expected three numbers X,Y,Z, such as 1,0.5,-2", flag, text));
}

bool parse_rgb(const std::string& text, Rgb& color) {
    const auto value = three_numbers(text);
    if (value) color = {value->x, value->y, value->z};
    return value.has_value();
}

} // namespace pertev
