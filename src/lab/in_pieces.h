#pragma once

// Long work over a range, cut into pieces of about a tenth of a second, so that whoever waits for it can be told how
// far it is and can stop it between two of them. Where the cuts lie depends on the clock: the work must not depend on
// them.

#include <algorithm>
#include <cstdint>
#include <functional>

#include "base/parallel_for.h"
#include "base/stopwatch.h"

namespace pertev {

/// Told after each piece: the share that is done, (0, 1]. May throw, which ends the work.
using PieceDone = std::function<void(double share)>;

/// For rays that a CPU walks: as many as launch() gives a thread at a time, for each thread; whole packets.
inline uint64_t first_piece_of_rays() { return 256 * static_cast<uint64_t>(thread_count()); }

/// Calls work(begin, count) over parts of [0, count), which together are all of it; work returns when it is done. The
/// first part has `first` elements, and none has fewer but the last.
template <class Work>
void in_pieces(uint64_t count, uint64_t first, const Work& work, const PieceDone& done) {
    constexpr double least_s = 0.05, most_s = 0.2;
    uint64_t piece = first;
    for (uint64_t begin = 0; begin < count;) {
        const Stopwatch watch;
        const uint64_t now = std::min(piece, count - begin);
        work(begin, now);
        begin += now;
        const double seconds = watch.seconds();
        if (done) done(static_cast<double>(begin) / static_cast<double>(count));
        if (seconds < least_s) piece *= 2;
        if (seconds > most_s) piece = std::max(first, piece / 2);
    }
}

} // namespace pertev
