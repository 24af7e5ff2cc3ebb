#include "session/devices/sample_slices.h"

#include <algorithm>

namespace pertev {

uint32_t SampleSlices::count_for(double rate, double most_s) const {
    if (fixed_count_ > 0) return fixed_count_;
    if (!(rate > 0)) return std::max(first_count_, 1u);
    double left = is_ended_ ? 0 : range_.end - next_;
    for (const SampleRange& lost : lost_) left += lost.count();
    const double share = left / (4.0 * static_cast<double>(devices_));
    const double count = std::min(rate * kSliceSeconds, std::max(share, rate * kLeastSliceSeconds));
    return static_cast<uint32_t>(std::clamp(std::min(count, rate * most_s), 1.0, 65536.0));
}

std::optional<SampleRange> SampleSlices::take(double rate, double most_s) {
    if (is_empty()) return std::nullopt;
    const uint32_t count = count_for(rate, most_s);
    if (lost_.empty()) {
        const uint32_t first = next_;
        next_ += std::min(count, range_.end - next_);
        return SampleRange{first, next_};
    }
    SampleRange& lost = lost_.back();
    const SampleRange slice = {lost.first, lost.first + std::min(count, lost.count())};
    lost.first = slice.end;
    if (lost.count() == 0) lost_.pop_back();
    return slice;
}

void SampleSlices::requeue(SampleRange lost) {
    if (lost.count() > 0) lost_.push_back(lost);
}

} // namespace pertev
