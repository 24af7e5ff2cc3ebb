#include "session/frame_sequence.h"

#include <cmath>

#include <fmt/format.h>

namespace pertev {

bool names_frames(const std::string& pattern) { return pattern.find('#', pattern.rfind('/') + 1) != std::string::npos; }

double FrameSequence::turn_at(uint32_t frame, double share) const {
    if (turntable == 0) return 0;
    const double of_frame = shutter && fps ? shutter->time_at(0, share) * *fps : 0;
    const double turns = (frame % turntable + of_frame) / turntable;
    return turns - std::floor(turns);
}

std::string frame_file(const std::string& pattern, uint32_t frame) {
    const std::size_t name = pattern.rfind('/') + 1; // npos + 1: 0
    std::string file = pattern.substr(0, name);
    for (std::size_t at = name; at < pattern.size();) {
        const std::size_t end = std::min(pattern.find_first_not_of('#', at), pattern.size());
        if (end > at) file += fmt::format("{:0{}}", frame, end - at);
        if (end < pattern.size()) file += pattern[end];
        at = end + 1;
    }
    return file;
}

} // namespace pertev
