#pragma once

// Numeric differences between a picture and its reference, which `pertev compare` prints and tests bound. FLIP is in
// image/flip.h. Sums are in double and in one fixed order.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "image/image.h"
#include "math/rgb.h"

namespace pertev {

struct TrimmedError {
    double rel_mse = 0;            // mean over the kept pixels and their channels of (x - r)^2 / (r^2 + 0.01)
    double mean[3] = {};           // mean of the picture's R, G, B over the kept pixels
    double reference_mean[3] = {}; // mean of the reference's R, G, B over the kept pixels
    uint64_t pixels = 0;           // number of kept pixels
};

/// relMSE over the fraction `keep`, in (0, 1], of the pixels with the least error, at least one, so that fireflies do
/// not dominate. A pixel with a value that is not finite counts as the worst, and makes rel_mse infinite if it is
/// kept. Both pictures have 3 or 4 channels (alpha is not compared). Throws Error(BadInput) if their sizes differ.
TrimmedError relative_error(const Image& picture, const Image& reference, double keep = 0.98);

struct TrimmedVariance {
    double rel_mse = 0; // expectation of relative_error with respect to the true picture
    double mean = 0;    // mean of all channels over the pixels
};

/// Variance of pictures that differ only by noise, as relMSE of one of them: s^2 / (m^2 + 0.01), where s^2 is the
/// unbiased variance of a pixel's channel over the pictures and m its mean. It takes them one by one and keeps two
/// sums per value, so that memory does not grow with their number.
class VarianceOfPictures {
public:
    /// Adds a picture with 3 or 4 channels (alpha is ignored). Throws Error(BadInput) if its size is not that of the
    /// first.
    void add(const Image& picture);
    /// The fraction `keep`, in (0, 1], of the pixels with the least variance, at least one, the best first. Needs two
    /// pictures.
    std::vector<std::size_t> best_pixels(double keep) const;
    /// Means over these pixels, and R, G, B. A pixel with a value that is not finite makes rel_mse infinite. Needs
    /// two pictures.
    TrimmedVariance over(const std::vector<std::size_t>& pixels) const;

private:
    TrimmedVariance of_pixel(std::size_t i) const;

    Image first_;                               // differences are relative to it, which preserves precision
    std::vector<double> differences_, squares_; // sums, [pixel][R, G, B]
    uint32_t count_ = 0;
};

/// Mean of (x - r)^2 over pixels and R, G, B; infinite if a value is not finite. Throws as relative_error.
double mean_squared_error(const Image& picture, const Image& reference);

/// Mean of |x - r| / (|r| + 0.01) over pixels and R, G, B; infinite if a value is not finite. Throws as relative_error.
double mean_absolute_percentage_error(const Image& picture, const Image& reference);
/// Mean of |x - r| / ((|x| + |r|) / 2 + 0.01), which treats both alike; otherwise as the function before.
double symmetric_percentage_error(const Image& picture, const Image& reference);

/// Mean of all channels and pixels.
double mean_of(const Image& image);
/// Mean of two pictures with equal sample counts, which is the picture of all samples.
Image mean_of(const Image& a, const Image& b);

/// Means over blocks of `side` x `side` pixels, side >= 1; blocks at the right and lower border average fewer
/// pixels. Sums are in double, row by row. Means over blocks have less
/// noise, by the block's side.
Image block_means(const Image& image, uint32_t side);

/// Throws Error(BadInput) with both sizes unless they are equal and each picture has 3 or 4 channels.
void check_comparable(const Image& picture, const Image& reference);

} // namespace pertev
