#include "render/pixel_filter.h"

#include "math/portable_math.h"

namespace pertev {
namespace {

/// Returns the filter's value at x in [-1, 1], in units of the radius; not normalised.
float filter_value(PixelFilter filter, float x) {
    if (filter == PixelFilter::Gaussian) return exp(-4.5f * x * x);
    const float phase = kPi * (x + 1.0f);
    return 0.35875f - 0.48829f * cos(phase) + 0.14128f * cos(2.0f * phase) - 0.01168f * cos(3.0f * phase);
}

} // namespace

float default_filter_radius(PixelFilter filter) {
    switch (filter) {
    case PixelFilter::Box:
        return 0.5f;
    case PixelFilter::Tent:
        return 1.0f;
    case PixelFilter::Gaussian:
        return 1.5f;
    case PixelFilter::BlackmanHarris:
        return 1.5f;
    }
    return 0.5f;
}

std::vector<float> make_filter_table(PixelFilter filter) {
    if (filter == PixelFilter::Box || filter == PixelFilter::Tent) return {};
    constexpr int steps = 64 * kFilterTableSize;
    std::vector<double> cumulative(steps + 1, 0.0);
    for (int i = 0; i < steps; ++i) {
        const float x = (static_cast<float>(i) + 0.5f) / static_cast<float>(steps) * 2.0f - 1.0f;
        cumulative[static_cast<std::size_t>(i) + 1] =
            cumulative[static_cast<std::size_t>(i)] + static_cast<double>(filter_value(filter, x));
    }
    std::vector<float> table(kFilterTableSize + 1);
    std::size_t step = 0;
    for (std::size_t i = 0; i <= kFilterTableSize; ++i) {
        const double at = static_cast<double>(i) / kFilterTableSize;
        const double of_tent = at < 0.5 ? 2 * at * at : 1 - 2 * (1 - at) * (1 - at);
        const double target = cumulative.back() * of_tent;
        while (step + 1 < steps && cumulative[step + 1] < target) ++step;
        const double width = cumulative[step + 1] - cumulative[step];
        const double within = width > 0 ? (target - cumulative[step]) / width : 0.0;
        table[i] = static_cast<float>((static_cast<double>(step) + within) / steps * 2.0 - 1.0);
    }
    return table;
}

} // namespace pertev
