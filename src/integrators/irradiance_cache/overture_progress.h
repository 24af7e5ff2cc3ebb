#pragma once

// How far the overture is: its rays so far, over those and the rays that are still to be expected. How many records its
// later rounds want is not known beforehand. Once records serve one another's places, the share of a grid that wants
// one falls from round to round, ever faster: of the Cornell box, 320x240, it is 0.64, 0.44, 0.21, 0.05, 0.007 from the
// third round on. So each fall is taken to be the 1.75th power of the one before. Until there is one, all are to be
// expected that there is room for.

#include <algorithm>
#include <cstdint>
#include <functional>

#include "base/stopwatch.h"

namespace pertev {

class OvertureProgress {
public:
    /// Of a picture of this size, in pixels. `record_rays`: a record's own rays, `room`: most records of all rounds.
    OvertureProgress(uint32_t width, uint32_t height, uint32_t record_rays, uint32_t room)
        : width_(width), height_(height), room_(room), rays_a_record_(3.0 * record_rays) {}

    /// The walks of the next round's grid begin. `rays`: of the overture so far, as in the next two.
    void begin_walks(uint64_t rays);
    /// They have ended, and want so many records.
    void begin_records(uint32_t wanted, uint64_t rays);
    /// [0, 1), never less than before: more rays than were expected are no end.
    double share(uint64_t rays);

private:
    uint32_t grid_count(uint32_t round) const;
    double rays_from(uint32_t round, double wanting) const;

    uint32_t width_, height_, room_;
    uint32_t round_ = 0;                     // under way
    bool has_begun_ = false;                 // the first one has
    uint64_t began_at_ = 0;                  // rays before the walks, or the records, under way
    double expected_ = 0, later_ = 0;        // rays of these, and of all that follows
    uint32_t wanted_ = 0, records_ = 0;      // of the round under way; of the rounds before
    double wanting_ = 1, falls_by_ = 1;      // share of the last grid that wanted records, over that of the one before
    double rays_a_walk_ = 2, rays_a_record_; // of the last ones that were done, or a guess
    double share_ = 0;
};

// Work that may take long, in parts short enough to be asked between them whether it is to go on.

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
