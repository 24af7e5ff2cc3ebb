#include "radiosity/work_watch.h"

#include <algorithm>

namespace pertev {

void WorkWatch::begin(std::string what, uint64_t pieces, double first, double last) {
    what_ = std::move(what) + note_;
    pieces_ = pieces;
    first_ = first, last_ = last;
    done_ = 0;
    share_ = 0;
    report();
}

bool WorkWatch::is_over() {
    if (is_over_.load(std::memory_order_relaxed)) return true;
    if (!progress_ || Clock::now().time_since_epoch().count() < next_.load(std::memory_order_relaxed)) return false;
    const std::unique_lock lock(telling_, std::try_to_lock);
    if (lock && Clock::now().time_since_epoch().count() >= next_.load(std::memory_order_relaxed)) report();
    return is_over_.load(std::memory_order_relaxed);
}

void WorkWatch::report() {
    if (!progress_ || is_over_) return;
    const double share = pieces_ > 0 ? static_cast<double>(done_.load()) / static_cast<double>(pieces_) : share_.load();
    if (!progress_(what_.c_str(), first_ + (last_ - first_) * std::clamp(share, 0.0, 1.0))) is_over_ = true;
    next_ = (Clock::now() + std::chrono::duration_cast<Clock::duration>(kInterval)).time_since_epoch().count();
}

} // namespace pertev
