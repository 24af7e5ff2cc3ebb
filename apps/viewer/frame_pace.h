#pragma once

// Chooses the resolution of moving pictures for a frame rate, from measured times only. There are few steps, and
// changes are delayed, because each change of size needs a new film and is visible. The first frame is small, and the
// next is as large as its time permits.

#include <cstdint>

namespace pertev {

class FramePace {
public:
    /// Target time of a frame in seconds.
    explicit FramePace(double frame_s) : frame_s_(frame_s) {}

    /// Records a frame at `scale` that took `seconds` for all its stages, and before it `other_s`, independently of
    /// its size (for moving the scene).
    void took(float scale, double seconds, double other_s = 0);
    /// Scale of each side of the picture: 1, 3/4, 1/2, 3/8, 1/4, 3/16, 1/8, 3/32, 1/16, 3/64 or 1/32.
    float scale() const;
    double frame_s() const { return frame_s_; }
    /// Estimated time of a full-size frame, in seconds; 0 if unknown.
    double full_s() const { return full_s_; }
    /// Sets another target time for the next scales.
    void keep(double frame_s) { frame_s_ = frame_s; }
    /// Returns whether frames of this scale meet the target time, by earlier frames.
    bool keeps_rate() const;

private:
    bool fits(int step, double headroom) const;

    double frame_s_;
    double full_s_ = 0;  // estimated time of a full-size frame; 0 if unknown
    double other_s_ = 0; // time outside of the last frame
    int step_ = 8;       // small until a frame has shown the speed of the machine
};

/// Side of the picture at this scale in pixels; at least 1.
uint32_t scaled_side(uint32_t side, float scale);

} // namespace pertev
