#include "image/significance.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace pertev {
namespace {

double p_value(double a, double b, double variance) {
    const double difference = std::abs(a - b);
    if (!std::isfinite(difference) || !(variance >= 0)) return 0;
    if (variance == 0) return difference <= 1e-4 * std::max(std::abs(a), std::abs(b)) ? 1 : 0;
    return std::erfc(difference / std::sqrt(2 * variance));
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
    return {-std::expm1(count * std::log1p(-least)), below / count};
}

} // namespace pertev
