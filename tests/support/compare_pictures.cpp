#include "tests/support/compare_pictures.h"

#include <algorithm>
#include <cmath>

#include "render/light_paths/light_path_layers.h"

namespace pertev::test {
namespace {

/// Returns the probability of |T| >= t for Student's T, by its integral over atan(t / sqrt(degrees)).
double student_p_value(double t, double degrees) {
    constexpr int kSteps = 250; // Simpson's rule
    const double from = std::atan(t / std::sqrt(degrees)), step = (1.5707963267948966 - from) / kSteps;
    double sum = 0;
    for (int i = 0; i < kSteps; ++i) {
        const double weight = i == 0 ? 1 : i % 2 == 1 ? 4 : 2;
        sum += weight * std::pow(std::cos(from + i * step), degrees - 1);
    }
    const double log_scale = std::lgamma(0.5 * (degrees + 1)) - std::lgamma(0.5 * degrees);
    return std::min(1.0, 2 * std::exp(log_scale) / std::sqrt(3.141592653589793) * sum * step / 3);
}

} // namespace

PictureEstimate estimate_of(uint32_t renders, const std::function<Image(uint32_t)>& render) {
    std::size_t count = 0;
    std::vector<double> sum, square_sum;
    for (uint32_t number = 0; number < renders; ++number) {
        const Image picture = render(number);
        const std::size_t pixels = picture.pixels.size() / 3;
        std::vector<double> values(picture.pixels.begin(), picture.pixels.end());
        count = 3 * pixels + 3;
        values.resize(count);
        sum.resize(count);
        square_sum.resize(count);
        for (std::size_t i = 0; i < 3 * pixels; ++i) {
            values[3 * pixels + i % 3] += values[i] / static_cast<double>(pixels);
        }
        for (std::size_t i = 0; i < count; ++i) {
            const double value = values[i];
            sum[i] += value;
            square_sum[i] += value * value;
        }
    }
    PictureEstimate result;
    result.renders = renders;
    for (std::size_t i = 0; i < count; ++i) {
        const double mean = sum[i] / renders;
        result.mean.push_back(mean);
        result.variance_of_mean.push_back(std::max(0.0, square_sum[i] / renders - mean * mean) / (renders - 1));
    }
    return result;
}

PictureEstimate estimate_picture(Queue& queue, const PreparedScene& prepared, const Camera& camera,
                                 RenderSettings settings, uint32_t renders, uint32_t first_seed) {
    return estimate_of(renders, [&](uint32_t number) {
        settings.path.seed = first_seed + number;
        RenderResult result = render_picture(queue, prepared, camera, settings);
        if (!settings.light_paths) return result.picture;
        return layer_named(result, settings.light_paths->expressions.front().name);
    });
}

double p_value(const PictureEstimate& a, const PictureEstimate& b) {
    double smallest = 1;
    for (std::size_t i = 0; i < a.mean.size(); ++i) {
        const double deviation = std::fabs(a.mean[i] - b.mean[i]);
        const double va = a.variance_of_mean[i], vb = b.variance_of_mean[i], variance = va + vb;
        if (deviation == 0) continue;
        if (variance == 0) return 0;
        const double degrees = variance * variance / (va * va / (a.renders - 1) + vb * vb / (b.renders - 1));
        smallest = std::min(smallest, student_p_value(deviation / std::sqrt(variance), degrees));
    }
    return -std::expm1(static_cast<double>(a.mean.size()) * std::log1p(-smallest));
}

PictureEstimate brightened(PictureEstimate e, double factor, double min_error) {
    const std::size_t values = e.pixel_values();
    for (std::size_t i = 0; i < values; ++i) {
        if (!(std::sqrt(e.variance_of_mean[i]) > min_error * e.mean[i])) continue;
        e.mean[values + i % 3] += (factor - 1) * e.mean[i] / (static_cast<double>(values) / 3);
        e.mean[i] *= factor;
    }
    return e;
}

} // namespace pertev::test
