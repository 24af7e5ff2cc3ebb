#pragma once

// Compares the means of two ways to render. Each is rendered several times with independent samples, and Welch's test
// compares every channel of every pixel and of the whole picture.

#include <functional>
#include <vector>

#include "session/session.h"

namespace pertev::test {

/// The mean and its variance for every channel of every pixel and, at the end, of the whole picture, from independent
/// renders.
struct PictureEstimate {
    std::vector<double> mean, variance_of_mean;
    uint32_t renders; // the fewer, the less certain is the variance, so Student's t is used

    std::size_t pixel_values() const { return mean.size() - 3; }
};

/// Returns the estimate from the independent pictures render(0), ..., render(renders - 1).
PictureEstimate estimate_of(uint32_t renders, const std::function<Image(uint32_t)>& render);

/// Returns the estimate of the picture, or of the first light-path layer if the settings request any. Renders with
/// seeds first_seed, first_seed + 1, ..., so that pictures are independent for any sampler. Stratified samples have
/// half to a quarter of the variance of independent ones. Where the light of a pixel comes from rare samples, their
/// mean looks more certain than it is.
PictureEstimate estimate_picture(Queue& queue, const PreparedScene& prepared, const Camera& camera,
                                 RenderSettings settings, uint32_t renders, uint32_t first_seed);

/// Returns the two-sided p-value of the largest deviation by Welch's test, Sidak corrected.
double p_value(const PictureEstimate& a, const PictureEstimate& b);

/// Returns the picture, brightened in pixels whose means have an error above `min_error`, which excludes the
/// background.
PictureEstimate brightened(PictureEstimate estimate, double factor, double min_error);

} // namespace pertev::test
