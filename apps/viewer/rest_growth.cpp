#include "apps/viewer/rest_growth.h"

#include <algorithm>

namespace pertev {
namespace {

constexpr float kGrowthScales[] = {0.03125f, 0.0625f, 0.125f, 0.25f, 0.5f, 1.0f};

} // namespace

void RestGrowth::begin(float shown, double guess_s) {
    shown_ = shown;
    full_s_ = std::max(full_s_, guess_s); // if that is too much, the first picture will correct it
}

void RestGrowth::took(float scale, double seconds) {
    full_s_ = seconds / (static_cast<double>(scale) * static_cast<double>(scale));
}

std::optional<float> RestGrowth::next(bool has_whole) const {
    if (!is_slow()) return std::nullopt;
    std::optional<float> chosen;
    for (const float scale : kGrowthScales) {
        if (scale <= shown_ || (scale == 1 && !has_whole)) continue;
        const double seconds = full_s_ * static_cast<double>(scale) * static_cast<double>(scale);
        if (!chosen || seconds <= kFirst) chosen = scale;
    }
    return chosen;
}

} // namespace pertev
