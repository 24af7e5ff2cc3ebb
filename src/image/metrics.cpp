#include "image/metrics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <fmt/format.h>

#include "base/error.h"
#include "math/scalar.h"

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

/// Returns the mean of error(x, r) over pixels and R, G, B; infinite if a value is not finite.
template <class Error>
double mean_over(const Image& picture, const Image& reference, const Error& error) {
    check_comparable(picture, reference);
    const std::size_t count = std::size_t(picture.width) * picture.height;
    double sum = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const Rgb x = pixel(picture, i), r = pixel(reference, i);
        if (!is_finite(x) || !is_finite(r)) return kInfinite;
        sum += error(x.r, r.r) + error(x.g, r.g) + error(x.b, r.b);
    }
    return sum / (3 * static_cast<double>(count));
}

/// Returns the fraction `keep` of the pixels with the least errors, at least one, in ascending order of their errors.
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

void VarianceOfPictures::add(const Image& picture) {
    if (count_ == 0) {
        check_comparable(picture, picture);
        first_ = picture;
        differences_.assign(std::size_t(picture.width) * picture.height * 3, 0);
        squares_ = differences_;
    }
    check_comparable(picture, first_);
    for (std::size_t i = 0; i < differences_.size() / 3; ++i) {
        const Rgb x = pixel(picture, i), origin = pixel(first_, i);
        const double differences[3] = {double(x.r) - double(origin.r), double(x.g) - double(origin.g),
                                       double(x.b) - double(origin.b)};
        for (int c = 0; c < 3; ++c) {
            differences_[3 * i + c] += differences[c];
            squares_[3 * i + c] += differences[c] * differences[c];
        }
    }
    ++count_;
}

TrimmedVariance VarianceOfPictures::of_pixel(std::size_t i) const {
    const double n = count_;
    const Rgb first = pixel(first_, i);
    const float origin[3] = {first.r, first.g, first.b};
    TrimmedVariance result;
    for (int c = 0; c < 3; ++c) {
        const double sum = differences_[3 * i + c], squares = squares_[3 * i + c];
        const double mean = double(origin[c]) + sum / n;
        const double variance = std::max(0.0, squares - sum * sum / n) / (n - 1);
        result.rel_mse += std::isfinite(squares) ? variance / (mean * mean + 0.01) / 3 : kInfinite;
        result.mean += mean / 3;
    }
    return result;
}

std::vector<std::size_t> VarianceOfPictures::best_pixels(double keep) const {
    PERTEV_CHECK(count_ >= 2);
    std::vector<double> errors(differences_.size() / 3);
    for (std::size_t i = 0; i < errors.size(); ++i) errors[i] = of_pixel(i).rel_mse;
    return pixels_of_least_error(errors, keep);
}

TrimmedVariance VarianceOfPictures::over(const std::vector<std::size_t>& pixels) const {
    PERTEV_CHECK(count_ >= 2 && !pixels.empty());
    TrimmedVariance result;
    for (const std::size_t i : pixels) {
        PERTEV_CHECK(i < differences_.size() / 3);
        const TrimmedVariance one = of_pixel(i);
        result.rel_mse += one.rel_mse / static_cast<double>(pixels.size());
        result.mean += one.mean / static_cast<double>(pixels.size());
    }
    return result;
}

double mean_squared_error(const Image& picture, const Image& reference) {
    return mean_over(picture, reference, square_of_difference);
}

double mean_absolute_percentage_error(const Image& picture, const Image& reference) {
    return mean_over(picture, reference,
                     [](float x, float r) { return std::abs(double(x) - double(r)) / (std::abs(double(r)) + 0.01); });
}

double symmetric_percentage_error(const Image& picture, const Image& reference) {
    return mean_over(picture, reference, [](float x, float r) {
        return std::abs(double(x) - double(r)) / (0.5 * (std::abs(double(x)) + std::abs(double(r))) + 0.01);
    });
}

Image block_means(const Image& image, uint32_t side) {
    PERTEV_CHECK(side >= 1);
    Image means{(image.width + side - 1) / side, (image.height + side - 1) / side, image.channels, {}};
    means.pixels.reserve(std::size_t(means.width) * means.height * means.channels);
    for (uint32_t block_y = 0; block_y < image.height; block_y += side) {
        for (uint32_t block_x = 0; block_x < image.width; block_x += side) {
            const uint32_t end_x = min(block_x + side, image.width), end_y = min(block_y + side, image.height);
            for (uint32_t c = 0; c < image.channels; ++c) {
                double sum = 0;
                for (uint32_t y = block_y; y < end_y; ++y) {
                    for (uint32_t x = block_x; x < end_x; ++x) {
                        sum +=
                            static_cast<double>(image.pixels[(std::size_t(y) * image.width + x) * image.channels + c]);
                    }
                }
                means.pixels.push_back(static_cast<float>(sum / (double(end_x - block_x) * (end_y - block_y))));
            }
        }
    }
    return means;
}

double mean_of(const Image& image) {
    double sum = 0;
    for (const float value : image.pixels) sum += static_cast<double>(value);
    return sum / static_cast<double>(image.pixels.size());
}

Image mean_of(const Image& a, const Image& b) {
    Image mean = a;
    for (std::size_t i = 0; i < mean.pixels.size(); ++i) mean.pixels[i] = 0.5f * a.pixels[i] + 0.5f * b.pixels[i];
    return mean;
}

} // namespace pertev
