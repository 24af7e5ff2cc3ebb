// The flags that say what moves, and at which times.

#include <cmath>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "apps/cli/flag_checks.h"
#include "apps/cli/parse_values.h"
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

void add_motion_flags(CLI::App& verb, RenderFlags& flags) {
    const char* group = "Motion";
    verb.add_option("--frames", flags.frames,
                    "pictures from frame A to frame B; in the name of each output\na run of # is the frame's number: "
                    "-o frame-####.png")
        ->type_name("A-B")
        ->group(group);
    verb.add_option("--fps", flags.fps, "of --frames: frames a second; frame k is at k / F seconds (24)")
        ->type_name("F")
        ->check(number_above_zero(1e6f))
        ->group(group);
    verb.add_flag("--continue", flags.goes_on,
                  "of a sequence that was interrupted: keep the frames that are\nthere whole")
        ->group(group);
}

void add_shutter_flag(CLI::App& verb, RenderFlags& flags) {
    verb.add_option(
            "--shutter", flags.shutter,
            "what moves is blurred: the shutter is open for so long after the\ntime of the picture or frame, or "
            "from OPEN to CLOSE, counted\nfrom it (path, direct, indirect, distributed, whitted, cast)")
        ->type_name("[OPEN,]SECONDS")
        ->check([](const std::string& text) { return text.empty() ? "expected SECONDS, or OPEN,CLOSE" : ""; })
        ->group("Motion");
}

void check_motion_flags(const RenderFlags& flags) {
    const bool is_sequence = frame_sequence(flags).has_value();
    refuse(flags.time_s && !flags.frames.empty(), "--time: with --frames every frame has its own; say --fps");
    refuse(flags.fps > 0 && flags.frames.empty(), "--fps: of frames; say --frames A-B");
    if (const auto open = shutter(flags)) {
        refuse(open->close_s < open->open_s, fmt::format("--shutter {}: it closes before it opens", flags.shutter));
        refuse(flags.turntable > 0 && flags.frames.empty(),
               "--shutter: with --turntable it needs to know how long a turn takes; say --frames A-B and --fps");
        refuse(!flags.time_s && flags.frames.empty(),
               "--shutter: it is open about a time; say --time S, or --frames A-B");
    }
    refuse(flags.goes_on && !is_sequence, "--continue: of a sequence; say --frames A-B or --turntable N");
    refuse(flags.time_limit_s > 0 && is_sequence,
           "--time-limit: a sequence's frames have as many samples each; say --spp");
    for (const std::string& output : flags.outputs) {
        refuse(
            is_sequence && !names_frames(output),
            fmt::format("-o {}: each frame needs a file of its own; a run of # in its name is the frame's number: -o "
                        "frame-####.png",
                        output));
    }
}

std::optional<Shutter> shutter(const RenderFlags& flags) {
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

std::optional<FrameSequence> frame_sequence(const RenderFlags& flags) {
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

void add_time_flags(CLI::App& verb, RenderFlags& flags, bool plays) {
    const char* group = "Motion";
    verb.add_option("--time", flags.time_s,
                    fmt::format("the scene at this time of its animation, which plays from 0 on\n({})",
                                plays ? "without it, it plays" : "at rest"))
        ->type_name("SECONDS")
        ->check(number_between(-1e9f, 1e9f))
        ->group(group);
    verb.add_option("--camera-path", flags.camera_path,
                    "a JSON file of keys (time, eye, target, up, fov) that lead the\ncamera")
        ->type_name("FILE")
        ->check(file_name())
        ->group(group);
    verb.add_option("--turntable", flags.turntable,
                    plays ? "the camera goes once round what it looks at, in N / 24 s"
                          : "N pictures, with which the camera goes once round what it looks at")
        ->type_name("N")
        ->check(whole_between(1, kMostFrames))
        ->group(group);
}

} // namespace pertev
