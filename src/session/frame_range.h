#pragma once

// The frames of a moving picture: their numbers, their times, their files.

#include <cstdint>
#include <optional>
#include <string>

#include "base/limits.h"
#include "session/shutter.h"
#include "settings/picture_options.h"

namespace pertev {

struct FrameRange {
    uint32_t first = 0, last = 0;   // both are frames; first <= last
    std::optional<double> fps;      // frames a second; none: all frames are of one time
    std::optional<double> time_s;   // that time; none: at rest
    uint32_t turntable = 0;         // frames that the camera takes to go round once; 0: it does not
    std::optional<Shutter> shutter; // at each frame's time; none: a frame is of one moment

    uint32_t count() const { return last - first + 1; }
    /// Frame k of a moving scene is at k / fps seconds.
    std::optional<double> time_of(uint32_t frame) const { return fps ? std::optional(frame / *fps) : time_s; }
    /// The sample that a frame in real time takes of each pixel: the frame's number, as long as there are so many.
    static uint32_t sample_of(uint32_t frame) { return frame % kMaxSamplesPerPixel; }
    /// Share of a turn, in [0, 1).
    double turn_of(uint32_t frame) const { return turntable == 0 ? 0 : double(frame % turntable) / turntable; }
    /// The same after `share` in [0, 1] of the time that the shutter is open.
    double turn_at(uint32_t frame, double share) const;
    /// Of the frame before, also of the first one: motion vectors of a frame depend on no other that is rendered.
    std::optional<double> time_before(uint32_t frame) const {
        return fps ? std::optional((static_cast<double>(frame) - 1) / *fps) : time_s;
    }
    double turn_before(uint32_t frame) const { return turntable == 0 ? 0 : turn_of(frame % turntable + turntable - 1); }
};

/// Whether `pattern` names a file for each frame: it has a '#'.
bool names_frames(const std::string& pattern);
/// The file of a frame: its number in place of each run of '#', with zeros before it up to the run's length. All '#'
/// stand in the file's name, not in its folder's.
std::string frame_file(const std::string& pattern, uint32_t frame);

/// Returns how long the shutter is open; none if that was not given. Throws Error(BadInput).
std::optional<Shutter> shutter(const PictureOptions& options);
/// Returns the frames that are asked for; none for a single picture. Throws Error(BadInput).
std::optional<FrameRange> frame_range(const PictureOptions& options);

} // namespace pertev
