#pragma once

// Progress of the overture: its rays so far, over those and the expected ones. The number of records that later
// rounds request is not known in advance. Once records cover each other's points, the share of a grid that requests
// one falls from round to round, ever faster: for the Cornell box at 320x240 it is 0.64, 0.44, 0.21, 0.05, 0.007 from
// the third round on. So each ratio is assumed to be the 1.75th power of the one before. Before the first one, as
// many are expected as there is room for.

#include <algorithm>
#include <cstdint>
#include <functional>

#include "base/stopwatch.h"

namespace pertev {

class OvertureProgress {
public:
    /// Starts a picture of this size in pixels. `record_rays` are the rays of one record, `capacity` is the maximum
    /// number of records.
    OvertureProgress(uint32_t width, uint32_t height, uint32_t record_rays, uint32_t capacity)
        : width_(width), height_(height), capacity_(capacity), rays_a_record_(3.0 * record_rays) {}

    /// Starts the paths of the next round's grid. `rays` counts the overture's rays so far, here and in the next two.
    void begin_subpaths(uint64_t rays);
    /// Ends the paths, which requested `wanted` records.
    void begin_records(uint32_t wanted, uint64_t rays);
    /// Progress in [0, 1), never falling: more rays than expected do not complete it.
    double share(uint64_t rays);

private:
    uint32_t grid_count(uint32_t round) const;
    double rays_from(uint32_t round, double wanting) const;

    uint32_t width_, height_, capacity_;
    uint32_t round_ = 0;                        // current round
    bool has_begun_ = false;                    // whether the first round has begun
    uint64_t began_at_ = 0;                     // rays before the current paths or records
    double expected_ = 0, later_ = 0;           // expected rays of these, and of all that follows
    uint32_t wanted_ = 0, records_ = 0;         // records of the current round, and of the rounds before
    double wanting_ = 1, falls_by_ = 1;         // share of the last grid that requested records, and its ratio to the
                                                // one before
    double rays_a_subpath_ = 2, rays_a_record_; // rays of the last completed ones, or an estimate
    double share_ = 0;
};

// Long work is done in parts that are short enough to check between them whether to continue.

/// Limits of the size of a part. Within them it depends on the clock, which must not affect results.
struct PartSizes {
    uint64_t least, most;
};

/// Calls run(begin, end) over [0, count) in order, in parts of about a tenth of a second, and `goes_on` before each
/// and after the last. Returns false once `goes_on` does.
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
