#include "radiosity/work_watch.h"

#include <algorithm>

namespace pertev {

void WorkWatch::begin(std::string what, uint64_t pieces, double first, double last) {
    if (what + note_ != what_) {
        what_ = std::move(what) + note_;
        step_began_ = Clock::now();
        step_first_ = first;
    }
    pieces_ = pieces;
    first_ = first, last_ = last;
    done_ = 0;
    share_ = 0;
    report();
}

bool WorkWatch::is_over() {
    if (is_over_.load(std::memory_order_relaxed)) return true;
    if (Clock::now().time_since_epoch().count() < next_.load(std::memory_order_relaxed)) return false;
    const std::unique_lock lock(telling_, std::try_to_lock);
    if (lock && Clock::now().time_since_epoch().count() >= next_.load(std::memory_order_relaxed)) report();
    return is_over_.load(std::memory_order_relaxed);
}

void WorkWatch::report() {
    if (is_over_) return;
    const double share = pieces_ > 0 ? static_cast<double>(done_.load()) / static_cast<double>(pieces_) : share_.load();
    const auto seconds_since = [](Clock::time_point t) {
        return std::chrono::duration<double>(Clock::now() - t).count();
    };
    Progress now = {.doing = what_,
                    .share = first_ + (last_ - first_) * std::clamp(share, 0.0, 1.0),
                    .seconds = seconds_since(began_)};
    const double done = now.share - step_first_, seconds = seconds_since(step_began_);
    if (done > 0.01 && seconds > 1) now.seconds_left = seconds * (1 - now.share) / done;
    if (!sink_.goes_on(now)) is_over_ = true;
    next_ = (Clock::now() + std::chrono::duration_cast<Clock::duration>(kInterval)).time_since_epoch().count();
}

} // namespace pertev
