#include "session/sample_range.h"

#include <charconv>
#include <optional>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "base/limits.h"

namespace pertev {
namespace {

/// Parses "A:B" for the separator ':'; nothing for any other text, signs and spaces included.
std::optional<std::pair<uint32_t, uint32_t>> two_numbers(std::string_view text, char separator) {
    uint32_t a = 0, b = 0;
    const char* const end = text.data() + text.size();
    const auto [middle, fault] = std::from_chars(text.data(), end, a);
    if (fault != std::errc() || middle == end || *middle != separator) return std::nullopt;
    const auto [last, other_fault] = std::from_chars(middle + 1, end, b);
    if (other_fault != std::errc() || last != end) return std::nullopt;
    return std::pair(a, b);
}

SampleRange parse_samples(const std::string& text) {
    const auto range = two_numbers(text, ':');
    if (range && range->first < range->second && range->second <= kMaxSamplesPerPixel)
        return {range->first, range->second};
    throw Error(ErrorCode::BadInput, "samples", text,
                fmt::format("expected A:B with 0 <= A < B <= {}, as 64:128", kMaxSamplesPerPixel));
}

} // namespace

std::pair<uint32_t, uint32_t> row_range(const PictureOptions& options) {
    if (options.rows.empty()) return {0, 0};
    const auto rows = two_numbers(options.rows, ':');
    if (rows && rows->first < rows->second && rows->second <= kMaxImageSide) return *rows;
    throw Error(ErrorCode::BadInput, "rows", options.rows,
                fmt::format("expected A:B with 0 <= A < B <= {}, as 0:540", kMaxImageSide));
}

SampleRange sample_range(const PictureOptions& options) {
    if (!options.samples.empty()) return parse_samples(options.samples);
    const uint64_t all = options.render.samples;
    if (options.part.empty()) return {0, static_cast<uint32_t>(all)};
    const auto part = two_numbers(options.part, '/');
    if (!part || part->second == 0) {
        throw Error(ErrorCode::BadInput, "part", options.part, "expected I/N with N parts, as 1/4");
    }
    const uint64_t base = options.part_base, count = part->second;
    if (part->first < base || part->first >= base + count) {
        throw Error(ErrorCode::BadInput, "part", options.part,
                    fmt::format("expected a part from {} to {}", base, base + count - 1));
    }
    const uint64_t index = part->first - base;
    return {static_cast<uint32_t>(all * index / count), static_cast<uint32_t>(all * (index + 1) / count)};
}

} // namespace pertev
