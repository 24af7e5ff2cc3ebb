#pragma once

// The mean of random draws, with its standard error.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>

#include "image/image.h"

namespace pertev::test {

struct Estimate {
    double mean = 0, error = 0, variance = 0; // `error` is the standard error of the mean, `variance` that of one draw
};

inline Estimate estimate(uint64_t count, const std::function<double()>& draw) {
    double sum = 0, squares = 0;
    for (uint64_t i = 0; i < count; ++i) {
        const double value = draw();
        sum += value;
        squares += value * value;
    }
    const double n = static_cast<double>(count), mean = sum / n;
    const double variance = std::max(0.0, squares / n - mean * mean);
    return {mean, std::sqrt(variance / n), variance};
}

/// Mean of the first channel of a picture over its pixels, which are independent draws.
inline Estimate mean_over_pixels(const Image& picture) {
    std::size_t i = 0;
    const auto draw = [&] { return static_cast<double>(picture.pixels[picture.channels * i++]); };
    const std::size_t count = picture.pixels.size() / picture.channels;
    Estimate all = estimate(count, draw);
    all.error = std::sqrt(all.variance / static_cast<double>(count - 1));
    return all;
}

} // namespace pertev::test
