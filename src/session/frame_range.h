#pragma once

// The frames of a moving picture: their numbers, times and files.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/limits.h"
#include "session/sample_range.h"
#include "session/shutter.h"
#include "settings/picture_options.h"

namespace pertev {

struct FrameRange {
    uint32_t first = 0, last = 0;   // the range's ends, which belong to it; first <= last
    std::optional<double> fps;      // frames per second; without it all frames have one time
    std::optional<double> time_s;   // time of all frames without `fps`; without it the scene is at rest
    uint32_t turntable = 0;         // frames per revolution of the camera; 0: it does not revolve
    std::vector<std::string> names; // name of each frame's camera; empty: all frames have the same
    std::optional<Shutter> shutter; // around each frame's time; without it a frame shows one moment
    std::vector<uint32_t> cuts;     // frames whose history starts again, in order; the first frame's does
    std::optional<PartNumber> part; // the frames that this process writes; none: all

    uint32_t count() const { return last - first + 1; }
    /// Returns the frames [first, end) of the part.
    std::pair<uint32_t, uint32_t> of_part() const;
    /// Returns whether the history of a frame begins with it.
    bool is_cut(uint32_t frame) const;
    /// Returns the frame with which the history of `frame` begins.
    uint32_t cut_before(uint32_t frame) const;
    /// Time of a frame of a moving scene: k / fps seconds for frame k.
    std::optional<double> time_of(uint32_t frame) const { return fps ? std::optional(frame / *fps) : time_s; }
    /// Index of the sample per pixel that a real-time frame takes: the frame's number, modulo the maximum.
    static uint32_t sample_of(uint32_t frame) { return frame % kMaxSamplesPerPixel; }
    /// Index of the first of `count` samples per pixel that a frame with a history takes, as if those of all frames
    /// followed one another.
    static uint32_t first_sample_of(uint32_t frame, uint32_t count) {
        return frame % (kMaxSamplesPerPixel / count) * count;
    }
    /// Fraction of a revolution, in [0, 1).
    double turn_of(uint32_t frame) const { return turntable == 0 ? 0 : double(frame % turntable) / turntable; }
    /// Fraction of a revolution after `share` in [0, 1] of the time that the shutter is open.
    double turn_at(uint32_t frame, double share) const;
    /// Time of the previous frame. The first frame has one too, so that a frame's motion vectors do not depend on
    /// which others are rendered.
    std::optional<double> time_before(uint32_t frame) const {
        return fps ? std::optional((static_cast<double>(frame) - 1) / *fps) : time_s;
    }
    double turn_before(uint32_t frame) const { return turntable == 0 ? 0 : turn_of(frame % turntable + turntable - 1); }
};

/// Returns whether `pattern` names a file for each frame, that is, contains a '#' or "{name}".
bool names_frames(const std::string& pattern);
/// Name of a frame's file: the frame's number, zero-padded, replaces each run of '#', and the frame's of `names`, if
/// there are any, "{name}". All must be in the file's name, not in its folder's.
std::string frame_file(std::string pattern, uint32_t frame, std::span<const std::string> names = {});

/// Returns the times of the shutter; none if they were not given. Throws Error(BadInput).
std::optional<Shutter> shutter(const PictureOptions& options);
/// Returns the requested frames; none for a single picture. Throws Error(BadInput).
std::optional<FrameRange> frame_range(const PictureOptions& options);

} // namespace pertev
