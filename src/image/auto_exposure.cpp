#include "image/auto_exposure.h"

#include <algorithm>

#include "math/portable_math.h"
#include "math/rgb.h"

namespace pertev {

namespace {

/// Luminance of the pixel that begins at `p`; 0 where it is not finite.
double luminance_of(const float* p, uint32_t channels) {
    const float y = channels >= 3 ? luminance({p[0], p[1], p[2]}) : p[0];
    return is_finite(y) ? static_cast<double>(y) : 0.0;
}

/// Mean luminance of each of about 40 blocks along the longer side. Of single pixels the logarithms would tell of the
/// noise: few samples leave many pixels dark and a few bright, and the picture would come out too bright.
std::vector<float> block_luminances(const Image& image) {
    const uint32_t side = std::max<uint32_t>(1, std::max(image.width, image.height) / 40);
    const uint32_t columns = (image.width + side - 1) / side, rows = (image.height + side - 1) / side;
    std::vector<double> sums(std::size_t(columns) * rows);
    std::vector<uint32_t> counts(sums.size());
    for (uint32_t y = 0; y < image.height; ++y) {
        for (uint32_t x = 0; x < image.width; ++x) {
            const std::size_t block = std::size_t(y / side) * columns + x / side;
            sums[block] +=
                luminance_of(&image.pixels[(std::size_t(y) * image.width + x) * image.channels], image.channels);
            ++counts[block];
        }
    }
    std::vector<float> means(sums.size());
    for (std::size_t i = 0; i < sums.size(); ++i) means[i] = static_cast<float>(sums[i] / counts[i]);
    return means;
}

} // namespace

float auto_exposure_stops(const Image& linear) {
    std::vector<float> lit;
    for (const float y : block_luminances(linear)) {
        if (y > 0) lit.push_back(y);
    }
    if (lit.empty()) return 0;
    std::sort(lit.begin(), lit.end());
    const std::size_t cut = lit.size() / 10;
    double sum = 0;
    for (std::size_t i = cut; i < lit.size() - cut; ++i) sum += static_cast<double>(log2(lit[i]));
    const float mean = static_cast<float>(sum / static_cast<double>(lit.size() - 2 * cut));
    const float brightest = log2(lit[lit.size() - 1 - cut]); // but for the tenth that is cut
    return clamp(min(log2(0.18f) - mean, -brightest), -20.0f, 20.0f);
}

} // namespace pertev
