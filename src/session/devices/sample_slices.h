#pragma once

// The samples of a picture, which devices take in slices from a common counter. A slice is as long as its device needs
// for a fraction of a second, so a slow or busy one takes fewer samples and none waits for another for long at the end.
// One thread at a time may use it.

#include <cstdint>
#include <optional>
#include <vector>

#include "render/film.h"

namespace pertev {

/// Seconds of a slice while much is left. At its end a GPU has ever fewer paths in flight, so that longer
/// slices lose less: with 0.05 s two H100s were 1.93 times as fast as one, with 0.2 s 1.98 times. Ctrl-C and a time
/// limit wait for slices under way.
inline constexpr double kSliceSeconds = 0.2;
/// Seconds of the shortest slices, at the end of the picture. It is about what the last device is waited for.
inline constexpr double kLeastSliceSeconds = 0.005;

class SampleSlices {
public:
    /// `first_count` is the number of samples in a slice for a device of unknown speed. If `fixed_count` is not 0, all
    /// slices have this number.
    SampleSlices(SampleRange range, std::size_t devices, uint32_t first_count, uint32_t fixed_count)
        : range_(range), next_(range.first), devices_(devices), first_count_(first_count), fixed_count_(fixed_count) {}

    /// Returns the next slice for a device that takes `rate` samples per second (0: unknown) and should take it in
    /// `most_s` seconds; nothing if there is none at present. It has at least one sample.
    std::optional<SampleRange> take(double rate, double most_s);
    /// Queues samples that were lost again; take() returns them before all others, even after end().
    void requeue(SampleRange lost);
    /// Ends the counter: take() returns only queued samples from now on.
    void end() { is_ended_ = true; }

    /// Returns whether take() would return nothing.
    bool is_empty() const { return lost_.empty() && (is_ended_ || next_ == range_.end); }
    /// Returns how many samples have been handed out at least once. They are consecutive, from the first on.
    uint32_t handed_out() const { return next_ - range_.first; }

private:
    uint32_t count_for(double rate, double most_s) const;

    SampleRange range_;
    uint32_t next_;
    std::size_t devices_;
    uint32_t first_count_, fixed_count_;
    std::vector<SampleRange> lost_;
    bool is_ended_ = false;
};

} // namespace pertev
