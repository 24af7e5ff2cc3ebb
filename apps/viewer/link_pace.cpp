#include "apps/viewer/link_pace.h"

#include <algorithm>

namespace pertev {
namespace {

constexpr double kLate = 0.12; // seconds that a picture may take beyond the link's own least time
constexpr int kLowest = 30, kHighest = 92;

} // namespace

void LinkPace::sent(uint32_t frame, std::size_t bytes, double now_s) { under_way_.push_back({frame, bytes, now_s}); }

bool LinkPace::acknowledged(uint32_t frame, double now_s) {
    const auto found = std::ranges::find(under_way_, frame, &Sent::frame);
    if (found == under_way_.end()) return false;
    round_trip_s_ = std::max(now_s - found->at_s, 1e-6);
    least_s_ = std::min(least_s_ * 1.001, round_trip_s_); // forgets slowly: routes change
    // While two are under way, the second arrives a transfer's time after the first.
    const double transfer_s = std::max(now_s - std::max(found->at_s, last_ack_s_), 1e-4);
    const double rate = static_cast<double>(found->bytes) / transfer_s;
    rate_ = rate_ == 0 ? rate : rate_ + 0.25 * (rate - rate_);
    last_ack_s_ = now_s;
    under_way_.erase(under_way_.begin(), found + 1); // one before it that was not acknowledged never will be
    adapt();
    return true;
}

void LinkPace::adapt() {
    if (round_trip_s_ > least_s_ + kLate) {
        calm_ = 0;
        if (quality_ > kLowest) {
            quality_ = std::max(kLowest, quality_ - 10);
        } else {
            scale_ = std::max(0.25f, scale_ / 2);
        }
    } else if (++calm_ >= 8) {
        calm_ = 0;
        if (scale_ < 1) {
            scale_ *= 2;
        } else {
            quality_ = std::min(kHighest, quality_ + 4);
        }
    }
}

std::size_t LinkPace::piece_bytes(double seconds) const {
    constexpr double kLeast = 16384, kMost = 1 << 20;
    return static_cast<std::size_t>(std::clamp(rate_ * seconds, kLeast, kMost));
}

} // namespace pertev
