#include "image/significance.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.h"
#include "math/portable_math.h"

namespace pertev {
namespace {

/// Returns the complementary error function of x >= 0, whose relative error is at most 2e-7. Source: Press et al.,
/// "Numerical Recipes", 2nd ed., section 6.2, a Chebyshev fit of the logarithm.
double complementary_error(double x) {
    constexpr std::array kFit = {-1.26551223, 1.00002368,  0.37409196, 0.09678418,  -0.18628806,
                                 0.27886807,  -1.13520398, 1.48851587, -0.82215223, 0.17087277};
    const double t = 1 / (1 + 0.5 * x);
    double sum = 0;
    for (std::size_t i = kFit.size(); i-- > 0;) sum = kFit[i] + t * sum;
    const double exponent = sum - x * x;
    const auto rounded = static_cast<float>(exponent);
    return t * static_cast<double>(exp(rounded)) * (1 + (exponent - static_cast<double>(rounded)));
}

/// Returns the probability of at least one of `count` independent events of probability p each, which keeps its
/// precision where p is small.
double any_of(double p, std::size_t count) {
    double any = 0, power = p; // that of 2^k events
    for (; count > 0; count /= 2) {
        if (count % 2 == 1) any = any + power - any * power;
        power = power * (2 - power);
    }
    return any;
}

double p_value(double a, double b, double variance) {
    const double difference = std::abs(a - b);
    if (!std::isfinite(difference) || !(variance >= 0)) return 0;
    if (difference == 0) return 1;
    if (variance == 0) return difference <= 1e-4 * std::max(std::abs(a), std::abs(b)) ? 1 : 0;
    return complementary_error(difference / std::sqrt(2 * variance));
}

} // namespace

Image p_values(const Image& a, const Image& variance_a, const Image& b, const Image& variance_b) {
    const std::size_t pixels = std::size_t(a.width) * a.height;
    PERTEV_CHECK(variance_a.pixels.size() == 3 * pixels && variance_b.pixels.size() == 3 * pixels);
    Image p = {a.width, a.height, 3, {}};
    p.pixels.reserve(3 * pixels);
    for (std::size_t i = 0; i < pixels; ++i) {
        for (std::size_t c = 0; c < 3; ++c) {
            const double variance = double(variance_a.pixels[3 * i + c]) + double(variance_b.pixels[3 * i + c]);
            const double x = double(a.pixels[i * a.channels + c]), y = double(b.pixels[i * b.channels + c]);
            p.pixels.push_back(static_cast<float>(p_value(x, y, variance)));
        }
    }
    return p;
}

Significance significance_of(const Image& p) {
    const auto count = static_cast<double>(p.pixels.size());
    const double least = double(*std::ranges::min_element(p.pixels));
    const auto below = static_cast<double>(std::ranges::count_if(p.pixels, [](float x) { return x < 0.01f; }));
    return {any_of(least, p.pixels.size()), below / count};
}

} // namespace pertev
