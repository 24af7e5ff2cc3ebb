#include "apps/viewer/frame_pace.h"

#include <algorithm>
#include <iterator>

namespace pertev {
namespace {

constexpr float kScales[] = {1.0f, 0.75f, 0.5f, 0.375f, 0.25f, 0.1875f, 0.125f, 0.09375f, 0.0625f};
constexpr double kRoom = 0.8; // of the time that a larger picture must fit in

} // namespace

void FramePace::took(float scale, double seconds) {
    const double pixels = static_cast<double>(scale) * static_cast<double>(scale);
    const double full = seconds / pixels;
    full_s_ = full_s_ == 0 ? full : full_s_ + 0.35 * (full - full_s_);
    const auto fits = [&](int step, double room) {
        const double size = static_cast<double>(kScales[step]);
        return full_s_ * size * size <= room * frame_s_;
    };
    const int last = static_cast<int>(std::size(kScales)) - 1;
    while (step_ < last && !fits(step_, 1)) ++step_;
    if (step_ > 0 && fits(step_ - 1, kRoom)) --step_;
}

float FramePace::scale() const { return kScales[step_]; }

uint32_t scaled_side(uint32_t side, float scale) {
    return std::max(1u, static_cast<uint32_t>(static_cast<float>(side) * scale + 0.5f));
}

} // namespace pertev
