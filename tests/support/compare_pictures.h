#pragma once

// Compares the means of two ways to render: each is rendered several times with independent samples, and every channel
// of every pixel, and of the whole picture, is compared by Welch's test.

#include <functional>
#include <vector>

#include "session/session.h"

namespace pertev::test {

/// Mean and variance of the mean for every channel of every pixel, and last for the whole picture, from independent
/// renders of independent samples.
struct PictureEstimate {
    std::vector<double> mean, variance_of_mean;
    uint32_t renders; // the fewer, the less a variance is known: hence Student's t below

    std::size_t pixel_values() const { return mean.size() - 3; }
};

/// Estimate from pictures render(0), ..., render(renders - 1), which are independent.
PictureEstimate estimate_of(uint32_t renders, const std::function<Image(uint32_t)>& render);

/// Estimate of the picture, or of the first light-path layer if the settings request any. Renders with seeds
/// first_seed, first_seed + 1, ..., so that pictures are independent of each other whatever sampler the settings
/// choose. Stratified samples leave half to a quarter of the variance of independent ones, but of a pixel that rarely
/// gets much of its light they leave a mean that looks more certain than it is.
PictureEstimate estimate_picture(Queue& queue, const PreparedScene& prepared, const Camera& camera,
                                 RenderSettings settings, uint32_t renders, uint32_t first_seed);

/// Two-sided p-value of the largest deviation of all, Sidak corrected; of two means by Welch's test.
double p_value(const PictureEstimate& a, const PictureEstimate& b);

/// The picture, brighter in the pixels whose means have an error above `min_error`, which excludes the background.
PictureEstimate brightened(PictureEstimate estimate, double factor, double min_error);

} // namespace pertev::test
