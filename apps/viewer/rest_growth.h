#pragma once

// The sizes that a picture at rest goes through before its samples gather, where a sample of all pixels takes long:
// first one that is there at once, then each twice as wide and high. Pure arithmetic over measured times. The sizes
// before the full one take a third of a sample's time together.

#include <optional>

namespace pertev {

class RestGrowth {
public:
    /// A sample that takes less needs nothing before it, seconds. A new setting may take twice as long as the one
    /// before.
    static constexpr double kSoon = 0.5;
    /// The first picture takes no longer than this, by what is known, seconds. A new setting may take 4 times as long.
    static constexpr double kFirst = 0.25;

    /// `soon_s`: as kSoon.
    explicit RestGrowth(double soon_s = kSoon) : soon_s_(soon_s) {}

    /// Another picture begins. `shown`: the scale of one of the same view that is shown already; 0: there is none.
    /// `guess_s`: what a sample of all pixels takes by the frames of the movement, seconds; 0: nothing is known.
    void begin(float shown, double guess_s);
    /// A picture of this scale took so long. That is what counts from now on.
    void took(float scale, double seconds);
    /// A picture of this scale is shown now.
    void showed(float scale) { shown_ = scale; }
    /// Whether a sample takes long, so that nobody should have to wait for one.
    bool is_slow() const { return full_s_ > soon_s_; }
    /// Whether a sample that takes so long may be waited for, even by somebody who moves the camera.
    bool is_short(double sample_s) const { return sample_s <= kShort * soon_s_; }
    /// Returns the scale of the next picture, or nothing where the samples of the full one may gather. `has_whole`:
    /// a last picture of full size comes before the samples.
    std::optional<float> next(bool has_whole) const;

private:
    static constexpr double kShort = 0.4;
    double soon_s_;
    float shown_ = 0;
    double full_s_ = 0; // of a sample of all pixels
};

} // namespace pertev
