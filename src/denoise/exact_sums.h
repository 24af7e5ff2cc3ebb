#pragma once

// Exact sums of what a denoiser gathers of each pixel's samples: whole numbers of 64 bits. The order of samples does
// not affect the result, so that sums of parts of a picture's samples add up to those of one run. A sum takes one
// number, or two or three where its values have a wide range. Each of these takes kMaxSamplesPerPixel values.

#include <cstddef>
#include <cstdint>

#include "base/host_device.h"
#include "math/rgb.h"
#include "render/fixed_sum.h"

namespace pertev {

struct ExactSums {
    int64_t* numbers; // one array over the pixels after the other
    uint32_t pixels;

    HD int64_t& at(uint32_t array, uint32_t pixel) const { return numbers[std::size_t(array) * pixels + pixel]; }

    /// Adds to the sum that begins at `array`. Most sums of a sample are 0, and then touch no memory.
    HD void add(uint32_t array, uint32_t pixel, int64_t value) const {
        if (value != 0) at(array, pixel) += value;
    }
};

/// Sums of values up to 2^kLog2Most, such as reflectances, in units of 2^(kLog2Most - 39). Larger ones are clamped.
template <int kLog2Most>
struct SmallSum {
    static constexpr uint32_t kArrays = 1;
    static constexpr float kMost = static_cast<float>(1 << kLog2Most);
    static constexpr float kPerUnit = static_cast<float>(int64_t(1) << (39 - kLog2Most));

    HD static void add(const ExactSums& sums, uint32_t array, uint32_t pixel, float x) {
        const float held = x > -kMost ? min(x, kMost) : -kMost; // not a number: -kMost
        sums.add(array, pixel, static_cast<int64_t>(held * kPerUnit));
    }
    HD static double get(const ExactSums& sums, uint32_t array, uint32_t pixel) {
        return static_cast<double>(sums.at(array, pixel)) * (1.0 / static_cast<double>(kPerUnit));
    }
};

/// Sums of light, in units of 2^-40 and up to kMaxSampleValue (2^40), to which larger values are clamped.
struct LightSum {
    static constexpr uint32_t kArrays = 2;

    HD static void add(const ExactSums& sums, uint32_t array, uint32_t pixel, float x) {
        const FixedSum fixed = fixed_within(x);
        sums.add(array, pixel, static_cast<int64_t>(fixed.low >> 24));
        sums.add(array + 1, pixel, static_cast<int64_t>(fixed.high));
    }
    HD static double get(const ExactSums& sums, uint32_t array, uint32_t pixel) {
        return static_cast<double>(sums.at(array + 1, pixel)) + static_cast<double>(sums.at(array, pixel)) * 0x1p-40;
    }
    /// Converts x, clamped to kMaxSampleValue; not a number is 0.
    HD static FixedSum fixed_within(float x) {
        constexpr float kMost = static_cast<float>(kMaxSampleValue);
        if (abs(x) <= kMost) return to_fixed(x);
        return x > 0 ? to_fixed(kMost) : x < 0 ? to_fixed(-kMost) : FixedSum{};
    }
};

/// Sums of squares of light, in units of 2^-48 and up to 2^56, to which larger values are clamped.
struct SquareSum {
    static constexpr uint32_t kArrays = 3;

    HD static void add(const ExactSums& sums, uint32_t array, uint32_t pixel, float x) {
        const FixedSum fixed = LightSum::fixed_within(x * 0x1p-16f);
        sums.add(array, pixel, static_cast<int64_t>(fixed.low & 0xffffffu));
        sums.add(array + 1, pixel, static_cast<int64_t>(fixed.low >> 24));
        sums.add(array + 2, pixel, static_cast<int64_t>(fixed.high));
    }
    HD static double get(const ExactSums& sums, uint32_t array, uint32_t pixel) {
        return static_cast<double>(sums.at(array + 2, pixel)) * 0x1p16 +
               static_cast<double>(sums.at(array + 1, pixel)) * 0x1p-24 +
               static_cast<double>(sums.at(array, pixel)) * 0x1p-48;
    }
};

/// Three sums of a kind, one array after the other.
template <class Sum>
struct SumsOfRgb {
    static constexpr uint32_t kArrays = 3 * Sum::kArrays;

    HD static void add(const ExactSums& sums, uint32_t array, uint32_t pixel, Rgb x) {
        Sum::add(sums, array, pixel, x.r);
        Sum::add(sums, array + Sum::kArrays, pixel, x.g);
        Sum::add(sums, array + 2 * Sum::kArrays, pixel, x.b);
    }
    HD static Rgb get(const ExactSums& sums, uint32_t array, uint32_t pixel) {
        return plus({0, 0, 0}, sums, array, pixel);
    }
    /// Returns the sums and `first`, rounded once.
    HD static Rgb plus(Rgb first, const ExactSums& sums, uint32_t array, uint32_t pixel) {
        const auto both = [&](float of_first, uint32_t k) {
            return static_cast<float>(static_cast<double>(of_first) + Sum::get(sums, array + k * Sum::kArrays, pixel));
        };
        return {both(first.r, 0), both(first.g, 1), both(first.b, 2)};
    }
};

} // namespace pertev
