#pragma once

// The target of the variance: exact sums of the samples and of their squares,
// by channel. A sample is the float that a pixel would show with it alone.
//
// Units: values and squares below 2^40 are in the film's unit of 2^-64. Squares
// from 2^40 to 2^80 are summed apart, in a unit of 2^-16, so that 2^23 of the
// largest take 2^119 units: neither sum can overflow, and a dark pixel's
// squares keep as many digits as its light.

#include "render/film.h"

namespace pertev {

/// Sums of one channel.
struct Moments {
    FixedSum values, squares; // units of 2^-64
    FixedSum large_squares;   // units of 2^-16

    HD Moments operator+(const Moments& other) const {
        return {values + other.values, squares + other.squares, large_squares + other.large_squares};
    }
};

/// Sums of a pixel's red, green and blue.
struct PixelMoments {
    Moments channels[3];
};

/// The stage that adds sums, with one call per pixel.
struct AddMoments {
    const PixelMoments* from;
    PixelMoments* to;

    HD void operator()(uint32_t i) const {
        for (int c = 0; c < 3; ++c) to[i].channels[c] = to[i].channels[c] + from[i].channels[c];
    }
};

/// Returns the moments of one value, |x| <= kMaxSampleValue. Bits of the square
/// below its unit are cut.
HD inline Moments moments_of(float x) {
    const uint32_t bits = bits_of(x), exponent = bits >> 23 & 255;
    if (exponent == 0) return {to_fixed(x), {}, {}};
    // x^2 = square * 2^(2 exponent - 300), of at most 48 bits.
    const uint64_t mantissa = (bits & 0x7fffffu) | 0x800000u, square = mantissa * mantissa;
    const bool is_large = exponent >= 127 + 20;
    const int shift = 2 * static_cast<int>(exponent) - 300 + (is_large ? 16 : 64);
    FixedSum units;
    if (shift <= -64) {
        units = {0, 0};
    } else if (shift < 0) {
        units = {square >> -shift, 0};
    } else if (shift == 0) {
        units = {square, 0};
    } else {
        units = {square << shift, square >> (64 - shift)}; // shift <= 56
    }
    return is_large ? Moments{to_fixed(x), {}, units} : Moments{to_fixed(x), units, {}};
}

/// The stage that takes the moments of a film's only sample, with one call per
/// pixel of its view.
struct TakeMoments {
    FilmView film;
    PixelMoments* to; // [pixels of the view]

    HD void operator()(uint32_t i) const {
        const FixedSum* const sums = film.at_slot(FilmSlot{i});
        // Many particles may add to a pixel in one sample.
        for (int c = 0; c < 3; ++c)
            to[i].channels[c] = moments_of(clamp(mean_of(sums[c], 1), -kMaxSampleValue, kMaxSampleValue));
    }
};

/// Returns the unbiased estimate of the variance of the mean of `samples`
/// samples with these moments; 0 for fewer than two samples.
double variance_of_mean(const Moments& moments, uint64_t samples);

/// Layer `variance`: the estimated variance of the pixel's mean, which is that
/// of its samples divided by their number, in the square of the picture's unit.
/// It takes samples as independent, so it is too large where their sequence
/// (`sampler`) is better than that.
class VarianceTarget final : public ElementTarget<PixelMoments, AddMoments, 0> {
public:
    VarianceTarget(Queue& queue, std::size_t pixels) : ElementTarget(queue, pixels, "variance") {}
    void show(FilmView&) const override {}
    std::vector<FilmLayer> layers(uint32_t width, const RowSamples& samples) const override;
};

/// Lets a film that holds one sample of each pixel, and has this target, take
/// the sample's moments.
void take_moments(Queue& queue, const Film& film);

} // namespace pertev
