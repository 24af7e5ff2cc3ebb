// These flags say what moves, and at which times.

#include <fmt/format.h>

#include "apps/cli/flag_checks.h"
#include "apps/cli/render_flags.h"

namespace pertev {

void check_motion_flags(const RenderFlags& flags) {
    const bool is_sequence = frame_range(flags).has_value();
    if (const auto open = shutter(flags)) {
        refuse(open->close_s < open->open_s, fmt::format("--shutter {}: it closes before it opens", flags.shutter));
        refuse(flags.turntable > 0 && flags.frames.empty(),
               "--shutter: with --turntable, the duration of a turn is needed; add --frames A-B and --fps");
    }
    for (const std::string& output : flags.outputs) {
        refuse(
            is_sequence && !names_frames(output),
            fmt::format("-o {}: each frame needs a file of its own; a run of # in its name is the frame's number: -o "
                        "frame-####.png",
                        output));
    }
}

} // namespace pertev
