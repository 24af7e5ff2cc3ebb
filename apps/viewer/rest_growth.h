#pragma once

// Sizes of the pictures at rest before samples accumulate, if a sample of all pixels takes long: first one that is
// available at once, then each twice as wide and high. It computes only with measured times. All sizes before the
// full one together take a third of a sample's time.

#include <optional>

namespace pertev {

class RestGrowth {
public:
    /// A shorter sample, in seconds, needs no smaller pictures before it. A new setting may take twice as long as the
    /// previous one.
    static constexpr double kSoon = 0.5;
    /// Maximum estimated time of the first picture in seconds. A new setting may take 4 times as long.
    static constexpr double kFirst = 0.25;

    /// `soon_s` replaces kSoon.
    explicit RestGrowth(double soon_s = kSoon) : soon_s_(soon_s) {}

    /// Begins another picture. `shown` is the scale of a picture of the same view that is already shown; 0: none.
    /// `guess_s` is the estimated time of a sample of all pixels from moving frames, in seconds; 0: unknown.
    void begin(float shown, double guess_s);
    /// A picture at this scale took this long, which replaces earlier estimates.
    void took(float scale, double seconds);
    /// A picture at this scale is shown now.
    void showed(float scale) { shown_ = scale; }
    /// Returns whether a sample takes too long to wait for.
    bool is_slow() const { return full_s_ > soon_s_; }
    /// Returns whether a sample of this time is short enough to finish even while the camera is moved.
    bool is_short(double sample_s) const { return sample_s <= kShort * soon_s_; }
    /// Returns the scale of the next picture, or nothing if full-size samples may accumulate. `has_whole` adds a last
    /// picture of full size before the samples.
    std::optional<float> next(bool has_whole) const;

private:
    static constexpr double kShort = 0.4;
    double soon_s_;
    float shown_ = 0;
    double full_s_ = 0; // time of a sample of all pixels
};

} // namespace pertev
