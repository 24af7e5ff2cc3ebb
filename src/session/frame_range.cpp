#include "session/frame_range.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/error.h"
#include "formats/files/parse_number.h"

namespace pertev {
namespace {

constexpr std::string_view kName = "{name}";
constexpr uint32_t kMaxFrames = 1'000'000'000;

constexpr double kMaxShutter = 1e6; // seconds, positive or negative

/// Parses a number; infinite if it is too large.
std::optional<double> seconds_in(std::string_view text) {
    const std::optional<double> value = parse_whole_float<double>(text);
    return value && !std::isnan(*value) ? value : std::nullopt;
}

/// Returns the frames before which there is a cut. Throws Error(BadInput).
std::vector<uint32_t> parse_cuts(const std::string& text) {
    std::vector<uint32_t> cuts;
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t comma = std::min(text.find(',', at), text.size());
        const auto cut = parse_whole_number(text.substr(at, comma - at));
        const bool is_later = cut && *cut <= kMaxFrames && (cuts.empty() || *cut > cuts.back());
        if (!is_later || comma + 1 == text.size()) {
            throw Error(ErrorCode::BadInput, "cuts", text,
                        fmt::format("expected K,K,..., increasing whole numbers up to {}", kMaxFrames));
        }
        cuts.push_back(static_cast<uint32_t>(*cut));
        at = comma + 1;
    }
    return cuts;
}

} // namespace

std::pair<uint32_t, uint32_t> FrameRange::of_part() const {
    const auto [from, to] = part.value_or(PartNumber()).of(uint64_t{last} - first + 1);
    return {static_cast<uint32_t>(first + from), static_cast<uint32_t>(first + to)};
}

bool FrameRange::is_cut(uint32_t frame) const { return frame == first || std::ranges::binary_search(cuts, frame); }

uint32_t FrameRange::cut_before(uint32_t frame) const {
    const auto later = std::ranges::upper_bound(cuts, frame);
    return later == cuts.begin() ? first : std::max(first, *std::prev(later));
}

bool names_frames(const std::string& pattern) {
    const std::size_t name = pattern.rfind('/') + 1; // npos + 1: 0
    return pattern.find('#', name) != std::string::npos || pattern.find(kName, name) != std::string::npos;
}

double FrameRange::turn_at(uint32_t frame, double share) const {
    if (turntable == 0) return 0;
    const double of_frame = shutter && fps ? shutter->time_at(0, share) * *fps : 0;
    const double turns = (frame % turntable + of_frame) / turntable;
    return turns - std::floor(turns);
}

std::string frame_file(std::string pattern, uint32_t frame, std::span<const std::string> names) {
    const std::size_t name = pattern.rfind('/') + 1; // npos + 1: 0
    std::string file = pattern.substr(0, name);
    const std::size_t camera = names.empty() ? std::string::npos : pattern.find(kName, name);
    if (camera != std::string::npos) { // a camera's name may contain a '#'
        return frame_file(pattern.substr(0, camera), frame) + names[frame] +
               frame_file(pattern.substr(camera + kName.size()), frame);
    }
    for (std::size_t at = name; at < pattern.size();) {
        const std::size_t end = std::min(pattern.find_first_not_of('#', at), pattern.size());
        if (end > at) file += fmt::format("{:0{}}", frame, end - at);
        if (end < pattern.size()) file += pattern[end];
        at = end + 1;
    }
    return file;
}

std::optional<Shutter> shutter(const PictureOptions& options) {
    if (options.shutter.empty()) return std::nullopt;
    const std::size_t comma = options.shutter.find(',');
    const std::optional<double> close = seconds_in(std::string_view(options.shutter).substr(comma + 1)); // npos + 1: 0
    const auto open = comma == std::string::npos ? 0.0 : seconds_in(std::string_view(options.shutter).substr(0, comma));
    const auto refuse = [&](std::string why) {
        throw Error(ErrorCode::BadInput, "shutter", options.shutter, std::move(why));
    };
    if (!open || !close) refuse("expected SECONDS, or OPEN,CLOSE, both relative to the picture's time");
    if (std::fabs(*open) > kMaxShutter || std::fabs(*close) > kMaxShutter)
        refuse(fmt::format("OPEN and CLOSE must be within {:g} s of the picture's time", kMaxShutter));
    if (*close < *open) refuse("the shutter closes before it opens");
    if (options.turntable > 0 && options.frames.empty())
        refuse("`turntable` needs the duration of a turn; set `frames` and `fps`");
    return Shutter{*open, *close};
}

std::optional<FrameRange> frame_range(const PictureOptions& options) {
    FrameRange sequence;
    sequence.shutter = shutter(options);
    sequence.turntable = options.turntable;
    sequence.time_s = options.time_s;
    sequence.part = part_number(options);
    sequence.cuts = parse_cuts(options.cuts);
    if (options.camera_list) {
        for (const CameraOfFile& camera : *options.camera_list) sequence.names.push_back(camera.name);
        sequence.last = static_cast<uint32_t>(sequence.names.size() - 1);
        return sequence;
    }
    if (options.frames.empty()) {
        if (options.turntable == 0) return std::nullopt;
        sequence.last = options.turntable - 1;
        return sequence;
    }
    const std::size_t dash = options.frames.find('-');
    const auto first = parse_whole_number(options.frames.substr(0, dash));
    const auto last = dash == std::string::npos ? first : parse_whole_number(options.frames.substr(dash + 1));
    if (!first || !last || *first > *last || *last > kMaxFrames) {
        throw Error(ErrorCode::BadInput, "frames", options.frames,
                    fmt::format("expected A-B, two whole numbers with A <= B <= {}", kMaxFrames));
    }
    sequence.first = static_cast<uint32_t>(*first);
    sequence.last = static_cast<uint32_t>(*last);
    sequence.fps = options.fps > 0 ? options.fps : 24;
    return sequence;
}

} // namespace pertev
