// These flags say what moves, and at which times.

#include <cmath>

#include <fmt/format.h>

#include "apps/cli/flag_checks.h"
#include "apps/cli/render_flags.h"
#include "base/error.h"
#include "base/limits.h"
#include "formats/files/parse_number.h"

namespace pertev {
namespace {

constexpr uint32_t kMostFrames = 1'000'000'000;

constexpr double kMostShutter = 1e6; // seconds, either way

/// As number_in, in double; infinite where it is too large.
std::optional<double> seconds_in(std::string_view text) {
    const std::optional<double> value = parse_whole_float<double>(text);
    return value && !std::isnan(*value) ? value : std::nullopt;
}

} // namespace

void check_motion_flags(const RenderFlags& flags) {
    const bool is_sequence = frame_sequence(flags).has_value();
    if (const auto open = shutter(flags)) {
        refuse(open->close_s < open->open_s, fmt::format("--shutter {}: it closes before it opens", flags.shutter));
        refuse(flags.turntable > 0 && flags.frames.empty(),
               "--shutter: with --turntable it needs to know how long a turn takes; say --frames A-B and --fps");
    }
    for (const std::string& output : flags.outputs) {
        refuse(
            is_sequence && !names_frames(output),
            fmt::format("-o {}: each frame needs a file of its own; a run of # in its name is the frame's number: -o "
                        "frame-####.png",
                        output));
    }
}

std::optional<Shutter> shutter(const PictureOptions& flags) {
    if (flags.shutter.empty()) return std::nullopt;
    const std::size_t comma = flags.shutter.find(',');
    const std::optional<double> close = seconds_in(std::string_view(flags.shutter).substr(comma + 1)); // npos + 1: 0
    const auto open = comma == std::string::npos ? 0.0 : seconds_in(std::string_view(flags.shutter).substr(0, comma));
    if (open && close) {
        refuse(!(std::fabs(*open) <= kMostShutter && std::fabs(*close) <= kMostShutter),
               fmt::format("--shutter {}: OPEN and CLOSE are {:g} s at most, either way", flags.shutter, kMostShutter));
        return Shutter{*open, *close};
    }
    throw Error(ErrorCode::BadInput,
                fmt::format("--shutter {}: expected SECONDS, or OPEN,CLOSE, both counted from the picture's time",
                            flags.shutter));
}

std::optional<FrameSequence> frame_sequence(const PictureOptions& flags) {
    FrameSequence sequence;
    sequence.shutter = shutter(flags);
    sequence.turntable = flags.turntable;
    sequence.time_s = flags.time_s;
    if (flags.frames.empty()) {
        if (flags.turntable == 0) return std::nullopt;
        sequence.last = flags.turntable - 1;
        return sequence;
    }
    const std::size_t dash = flags.frames.find('-');
    const auto first = parse_whole_number(flags.frames.substr(0, dash));
    const auto last = dash == std::string::npos ? first : parse_whole_number(flags.frames.substr(dash + 1));
    if (!first || !last || *first > *last || *last > kMostFrames) {
        throw Error(ErrorCode::BadInput,
                    fmt::format("--frames {}: expected A-B, two whole numbers of which the second is "
                                "not the smaller, up to {}",
                                flags.frames, kMostFrames));
    }
    sequence.first = static_cast<uint32_t>(*first);
    sequence.last = static_cast<uint32_t>(*last);
    sequence.fps = flags.fps > 0 ? flags.fps : 24;
    return sequence;
}

} // namespace pertev
