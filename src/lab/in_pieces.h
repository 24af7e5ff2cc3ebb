#pragma once

// Splits long work over a range into pieces of about a tenth of a second, so that the caller can report progress and
// stop between two pieces. The clock decides where the cuts lie: the result must not depend on them.

#include <algorithm>
#include <cstdint>
#include <functional>

#include "base/parallel_for.h"
#include "base/stopwatch.h"

namespace pertev {

/// A function that is called after each piece with the finished share, (0, 1]. It may throw, which ends the work.
using PieceDone = std::function<void(double share)>;

/// Returns the size of the first piece of rays that a CPU traces: for each thread, the number that launch() gives it at
/// a time, in whole packets.
inline uint64_t first_piece_of_rays() { return 256 * static_cast<uint64_t>(thread_count()); }

/// Calls work(begin, count) on consecutive parts of [0, count) that cover it; work must be finished when it returns.
/// The first part has `first` elements, and only the last part may have fewer.
template <class Work>
void in_pieces(uint64_t count, uint64_t first, const Work& work, const PieceDone& done) {
    constexpr double min_s = 0.05, max_s = 0.2;
    uint64_t piece = first;
    for (uint64_t begin = 0; begin < count;) {
        const Stopwatch watch;
        const uint64_t now = std::min(piece, count - begin);
        work(begin, now);
        begin += now;
        const double seconds = watch.seconds();
        if (done) done(static_cast<double>(begin) / static_cast<double>(count));
        if (seconds < min_s) piece *= 2;
        if (seconds > max_s) piece = std::max(first, piece / 2);
    }
}

} // namespace pertev
