#pragma once

// Which part of the full resolution a moving picture has, so that frames keep a rate: pure arithmetic over measured
// times. Few steps, and no step back at once: each change of size is a new film and a jump to the eye. The first frame
// is small, and the next as large as that one says.

#include <cstdint>

namespace pertev {

class FramePace {
public:
    /// Seconds that a whole frame may take.
    explicit FramePace(double frame_s) : frame_s_(frame_s) {}

    /// A frame of `scale` took so long, all its stages together; and before it `beside_s`, whatever its size (the scene
    /// moved).
    void took(float scale, double seconds, double beside_s = 0);
    /// Of each side of the picture: 1, 3/4, 1/2, 3/8, 1/4, 3/16, 1/8, 3/32, 1/16, 3/64 or 1/32.
    float scale() const;
    double frame_s() const { return frame_s_; }
    /// Seconds that a frame of full size would take, by those before; 0: nothing is known.
    double full_s() const { return full_s_; }
    /// Another time that a whole frame may take: the next scales keep that.
    void keep(double frame_s) { frame_s_ = frame_s; }
    /// Whether frames of this scale take no longer, by those before.
    bool keeps_rate() const;

private:
    bool fits(int step, double room) const;

    double frame_s_;
    double full_s_ = 0;   // of a frame at full size, by those before; 0: nothing is known
    double beside_s_ = 0; // of the last frame
    int step_ = 8;        // small, until a frame has told how fast the machine is
};

/// A side of the picture at this scale, pixels; at least 1.
uint32_t scaled_side(uint32_t side, float scale);

} // namespace pertev
