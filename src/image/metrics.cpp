#include "image/metrics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <fmt/format.h>

#include "base/error.h"
#include "math/portable_math.h"

namespace pertev {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();

Rgb pixel(const Image& image, std::size_t i) {
    const float* p = image.pixels.data() + i * image.channels;
    return {p[0], p[1], p[2]};
}

double square_of_difference(float x, float r) {
    const double difference = double(x) - double(r);
    return difference * difference;
}

double relative_square(float x, float r) { return square_of_difference(x, r) / (double(r) * double(r) + 0.01); }

/// The `keep` part of the pixels, those with the least errors first, at least one.
std::vector<std::size_t> pixels_of_least_error(const std::vector<double>& errors, double keep) {
    PERTEV_CHECK(keep > 0 && keep <= 1);
    std::vector<std::size_t> order(errors.size());
    std::iota(order.begin(), order.end(), std::size_t(0));
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return errors[a] != errors[b] ? errors[a] < errors[b] : a < b; // equal ones in one order everywhere
    });
    const auto kept = static_cast<std::size_t>(std::floor(keep * static_cast<double>(errors.size())));
    order.resize(std::max<std::size_t>(kept, 1));
    return order;
}

} // namespace

void check_comparable(const Image& picture, const Image& reference) {
    for (const Image* image : {&picture, &reference}) {
        PERTEV_CHECK(image->channels == 3 || image->channels == 4);
        PERTEV_CHECK(image->pixels.size() == std::size_t(image->width) * image->height * image->channels);
        PERTEV_CHECK(!image->pixels.empty());
    }
    if (picture.width != reference.width || picture.height != reference.height)
        throw Error(ErrorCode::BadInput,
                    fmt::format("pictures of {} x {} and {} x {} pixels cannot be compared; the sizes must be equal",
                                picture.width, picture.height, reference.width, reference.height));
}

TrimmedError relative_error(const Image& picture, const Image& reference, double keep) {
    check_comparable(picture, reference);
    const std::size_t count = std::size_t(picture.width) * picture.height;
    std::vector<double> errors(count);
    for (std::size_t i = 0; i < count; ++i) {
        const Rgb x = pixel(picture, i), r = pixel(reference, i);
        errors[i] = is_finite(x) && is_finite(r)
                        ? (relative_square(x.r, r.r) + relative_square(x.g, r.g) + relative_square(x.b, r.b)) / 3
                        : kInfinite;
    }
    const std::vector<std::size_t> order = pixels_of_least_error(errors, keep);

    TrimmedError result;
    result.pixels = order.size();
    for (const std::size_t i : order) {
        const Rgb x = pixel(picture, i), r = pixel(reference, i);
        result.rel_mse += errors[i];
        const float values[3] = {x.r, x.g, x.b}, reference_values[3] = {r.r, r.g, r.b};
        for (int c = 0; c < 3; ++c) {
            result.mean[c] += double(values[c]);
            result.reference_mean[c] += double(reference_values[c]);
        }
    }
    const double n = static_cast<double>(order.size());
    result.rel_mse /= n;
    for (int c = 0; c < 3; ++c) {
        result.mean[c] /= n;
        result.reference_mean[c] /= n;
    }
    return result;
}

TrimmedVariance relative_variance(const std::vector<Image>& pictures, double keep) {
    PERTEV_CHECK(pictures.size() >= 2);
    for (const Image& picture : pictures) check_comparable(picture, pictures.front());
    const std::size_t count = std::size_t(pictures[0].width) * pictures[0].height;
    const double n = static_cast<double>(pictures.size());
    std::vector<double> errors(count), means(count);
    for (std::size_t i = 0; i < count; ++i) {
        double sum[3] = {}, squares[3] = {}; // of the differences from the first picture, which lose no digits
        const Rgb first = pixel(pictures[0], i);
        const float origin[3] = {first.r, first.g, first.b};
        for (const Image& picture : pictures) {
            const Rgb x = pixel(picture, i);
            const float values[3] = {x.r, x.g, x.b};
            for (int c = 0; c < 3; ++c) {
                const double difference = double(values[c]) - double(origin[c]);
                sum[c] += difference;
                squares[c] += difference * difference;
            }
        }
        for (int c = 0; c < 3; ++c) {
            const double mean = double(origin[c]) + sum[c] / n;
            const double variance = std::max(0.0, squares[c] - sum[c] * sum[c] / n) / (n - 1);
            errors[i] += variance / (mean * mean + 0.01) / 3;
            means[i] += mean / 3;
        }
        if (std::isnan(errors[i])) errors[i] = kInfinite;
    }
    const std::vector<std::size_t> order = pixels_of_least_error(errors, keep);
    TrimmedVariance result;
    result.pixels = order.size();
    for (const std::size_t i : order) {
        result.rel_mse += errors[i] / static_cast<double>(order.size());
        result.mean += means[i] / static_cast<double>(order.size());
    }
    return result;
}

double mean_squared_error(const Image& picture, const Image& reference) {
    check_comparable(picture, reference);
    const std::size_t count = std::size_t(picture.width) * picture.height;
    double sum = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const Rgb x = pixel(picture, i), r = pixel(reference, i);
        if (!is_finite(x) || !is_finite(r)) return kInfinite;
        sum += square_of_difference(x.r, r.r) + square_of_difference(x.g, r.g) + square_of_difference(x.b, r.b);
    }
    return sum / (3 * static_cast<double>(count));
}

double peak_signal_to_noise(double mean_squared_error, double peak) {
    if (mean_squared_error == 0) return kInfinite;
    if (mean_squared_error == kInfinite) return -kInfinite;
    // Our own log2 is of floats: the exponent goes apart, so that no ratio is out of their range.
    int exponent = 0;
    const double mantissa = std::frexp(peak * peak / mean_squared_error, &exponent);
    constexpr double kDecibelsPerDoubling = 3.0102999566398120; // 10 log10(2)
    return kDecibelsPerDoubling * (exponent + double(log2(static_cast<float>(mantissa))));
}

} // namespace pertev
