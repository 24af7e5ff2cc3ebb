#pragma once

// Work that may take long, in parts short enough to be asked between them whether it is to go on.

#include <algorithm>
#include <cstdint>
#include <functional>

#include "base/stopwatch.h"

namespace pertev {

/// Sizes of a part. Between the two it follows the clock, which no result may depend on.
struct PartSizes {
    uint64_t least, most;
};

/// Calls run(begin, end) over [0, count) in order, in parts of about a tenth of a second, and asks `goes_on` before
/// each and after the last. Returns false once that is false.
template <class Run>
bool do_in_parts(uint64_t count, const PartSizes& sizes, const std::function<bool()>& goes_on, const Run& run) {
    constexpr double kShort = 0.04, kLong = 0.1; // seconds
    uint64_t size = sizes.least;
    for (uint64_t begin = 0; begin < count;) {
        if (!goes_on()) return false;
        const Stopwatch watch;
        const uint64_t end = begin + std::min(size, count - begin);
        run(begin, end);
        const double seconds = watch.seconds();
        if (seconds < kShort) size = std::min(2 * size, sizes.most);
        if (seconds > kLong) size = std::max(size / 2, sizes.least);
        begin = end;
    }
    return goes_on();
}

} // namespace pertev
