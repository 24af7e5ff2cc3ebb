#include "apps/viewer/link_pace.h"

#include <algorithm>
#include <limits>

namespace pertev {
namespace {

constexpr double kLate = 0.1, kEarly = 0.04; // transfer time of a picture's bytes, without the latency
constexpr double kMemory = 0.15;             // weight of the newest value in the running means
constexpr int kLowest = 30, kHighest = 92;
// Parameters of holding back: deviation of round trips without a queue, in seconds; fraction of any excess that is
// added at once; factor without excess; the maximum in units of the client's time per picture, more than one, because
// otherwise a queue would never shrink.
constexpr double kStray = 0.002, kStep = 0.5, kRelease = 0.98, kMaxHold = 1.2;

double min_of_late(double least, double value) { return least == 0 ? value : std::min(1.01 * least, value); }

} // namespace

void LinkPace::sent(uint32_t frame, std::size_t bytes, double now_s, bool is_piece) {
    in_flight_.push_back({frame, bytes, now_s, is_piece});
}

double LinkPace::may_send_at_s() const {
    if (in_flight_.empty()) return 0;
    return in_flight_.size() < kMaxInFlight ? in_flight_.back().at_s + hold_s_
                                            : std::numeric_limits<double>::infinity();
}

bool LinkPace::acknowledged(uint32_t frame, double now_s, double client_s) {
    const auto found = std::ranges::find(in_flight_, frame, &Sent::frame);
    if (found == in_flight_.end()) return false;
    const bool is_piece = found->is_piece;
    if (!is_piece) {
        round_trip_s_ = std::max(now_s - found->at_s, 1e-6);
        estimate_rate(static_cast<double>(found->bytes), round_trip_s_);
        hold(client_s);
    }
    // While two are in flight, the second arrives one transfer time after the first.
    const double transfer_s = std::max(now_s - std::max(found->at_s, last_ack_s_), 1e-4);
    const double rate = static_cast<double>(found->bytes) / transfer_s;
    rate_ = rate_ == 0 ? rate : rate_ + 0.25 * (rate - rate_);
    last_ack_s_ = now_s;
    const double bytes = static_cast<double>(found->bytes);
    in_flight_.erase(in_flight_.begin(), found + 1); // earlier ones that were not acknowledged never will be
    if (!is_piece) adapt(bytes);
    return true;
}

void LinkPace::estimate_rate(double bytes, double seconds) {
    const double share = bytes_ == 0 ? 1 : kMemory;
    bytes_ += share * (bytes - bytes_);
    seconds_ += share * (seconds - seconds_);
    bytes_squared_ += share * (bytes * bytes - bytes_squared_);
    bytes_seconds_ += share * (bytes * seconds - bytes_seconds_);
}

void LinkPace::hold(double client_s) {
    min_round_trip_s_ = min_of_late(min_round_trip_s_, round_trip_s_);
    min_client_s_ = min_of_late(min_client_s_, std::max(client_s, 0.0));
    const double late_s = round_trip_s_ - min_round_trip_s_ - kStray;
    hold_s_ = late_s > 0 ? std::min(hold_s_ + kStep * late_s, kMaxHold * min_client_s_) : kRelease * hold_s_;
}

void LinkPace::adapt(double bytes) {
    // The latency, known from a time when sizes varied, stays known while they do not.
    const double spread = bytes_squared_ - bytes_ * bytes_;
    if (spread > 0.01 * bytes_ * bytes_) {
        const double a_byte = std::max(0.0, (bytes_seconds_ - bytes_ * seconds_) / spread);
        latency_s_ = std::clamp(seconds_ - a_byte * bytes_, 0.0, seconds_);
    }
    const double transfer_s = bytes * (seconds_ - latency_s_) / bytes_;
    if (transfer_s > kLate) {
        calm_ = 0;
        if (quality_ > kLowest) {
            quality_ = std::max(kLowest, quality_ - 10);
        } else {
            scale_ = std::max(0.25f, scale_ / 2);
        }
    } else if (transfer_s < kEarly && ++calm_ >= 8) {
        calm_ = 0;
        if (scale_ < 1) {
            scale_ *= 2;
        } else {
            quality_ = std::min(kHighest, quality_ + 4);
        }
    }
}

std::size_t LinkPace::piece_bytes(double seconds) const {
    constexpr double kMinBytes = 16384, kMaxBytes = 1 << 20;
    return static_cast<std::size_t>(std::clamp(rate_ * seconds, kMinBytes, kMaxBytes));
}

} // namespace pertev
