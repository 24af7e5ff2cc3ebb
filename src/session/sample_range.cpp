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

std::optional<PartNumber> part_number(const PictureOptions& options) {
    if (options.part.empty()) return std::nullopt;
    const auto part = two_numbers(options.part, '/');
    if (!part || part->second == 0) {
        throw Error(ErrorCode::BadInput, "part", options.part, "expected I/N with N parts, as 1/4");
    }
    const uint64_t base = options.part_base, count = part->second;
    if (part->first < base || part->first >= base + count) {
        throw Error(ErrorCode::BadInput, "part", options.part,
                    fmt::format("expected a part from {} to {}", base, base + count - 1));
    }
    return PartNumber{part->first - base, count};
}

bool has_frames(const PictureOptions& options) {
    return !options.frames.empty() || options.turntable > 0 || !options.cameras.empty() || options.stereo ||
           options.camera_list;
}

SampleRange sample_range(const PictureOptions& options) {
    if (!options.samples.empty()) return parse_samples(options.samples);
    const std::optional<PartNumber> part = part_number(options);
    if (!part || has_frames(options)) return {0, options.render.samples};
    const auto [first, end] = part->of(options.render.samples);
    return {static_cast<uint32_t>(first), static_cast<uint32_t>(end)};
}

} // namespace pertev
