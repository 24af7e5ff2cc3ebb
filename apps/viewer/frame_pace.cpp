#include "apps/viewer/frame_pace.h"

#include <algorithm>
#include <iterator>

namespace pertev {
namespace {

constexpr float kScales[] = {1.0f, 0.75f, 0.5f, 0.375f, 0.25f, 0.1875f, 0.125f, 0.09375f, 0.0625f, 0.046875f, 0.03125f};
constexpr int kLast = static_cast<int>(std::size(kScales)) - 1;
constexpr double kHeadroom = 0.8;        // fraction of the time in which a larger picture must fit
constexpr double kMinPictureShare = 0.3; // minimum fraction of the frame's time that is attributed to the picture

} // namespace

bool FramePace::fits(int step, double headroom) const {
    const double size = static_cast<double>(kScales[step]);
    return full_s_ * size * size <= headroom * std::max(frame_s_ - other_s_, kMinPictureShare * frame_s_);
}

void FramePace::took(float scale, double seconds, double other_s) {
    const double pixels = static_cast<double>(scale) * static_cast<double>(scale);
    const double full = seconds / pixels;
    const bool is_first = full_s_ == 0;
    full_s_ = is_first ? full : full_s_ + 0.35 * (full - full_s_);
    other_s_ = other_s;
    while (step_ < kLast && !fits(step_, 1)) ++step_;
    const int least = is_first ? 0 : std::max(step_ - 1, 0);
    while (step_ > least && fits(step_ - 1, kHeadroom)) --step_;
}

bool FramePace::keeps_rate() const {
    const double size = static_cast<double>(scale());
    return full_s_ * size * size + other_s_ <= frame_s_;
}

float FramePace::scale() const { return kScales[step_]; }

uint32_t scaled_side(uint32_t side, float scale) {
    return std::max(1u, static_cast<uint32_t>(static_cast<float>(side) * scale + 0.5f));
}

} // namespace pertev
