#include "image/auto_exposure.h"

#include <algorithm>

#include "math/portable_math.h"
#include "math/rgb.h"

namespace pertev {

float auto_exposure_stops(const Image& linear) {
    std::vector<float> lit;
    for (std::size_t i = 0; i < linear.pixels.size(); i += linear.channels) {
        const float* p = &linear.pixels[i];
        const float y = linear.channels >= 3 ? luminance({p[0], p[1], p[2]}) : p[0];
        if (y > 0 && is_finite(y)) lit.push_back(y);
    }
    if (lit.empty()) return 0;
    std::sort(lit.begin(), lit.end());
    const std::size_t cut = lit.size() / 10;
    double sum = 0;
    for (std::size_t i = cut; i < lit.size() - cut; ++i) sum += static_cast<double>(log2(lit[i]));
    const float mean = static_cast<float>(sum / static_cast<double>(lit.size() - 2 * cut));
    return clamp(log2(0.18f) - mean, -20.0f, 20.0f);
}

} // namespace pertev
