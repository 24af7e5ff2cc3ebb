// Slices of samples that devices take from a common counter.

#include "session/devices/sample_slices.h"

#include <doctest/doctest.h>

#include <limits>

using namespace pertev;

namespace {

constexpr double kNoLimit = std::numeric_limits<double>::infinity();

} // namespace

TEST_CASE("slices of all devices cover each sample once, in order") {
    SampleSlices slices({5, 5000}, 3, 16, 0);
    uint32_t next = 5;
    for (int turn = 0; !slices.is_empty(); ++turn) {
        const auto slice = slices.take(turn % 3 == 0 ? 0 : 100.0 * (turn % 3), kNoLimit);
        REQUIRE(slice.has_value());
        CHECK(slice->first == next);
        CHECK(slice->count() > 0);
        next = slice->end;
        CHECK(slices.handed_out() == next - 5);
    }
    CHECK(next == 5000);
    CHECK(!slices.take(100, kNoLimit));
}

TEST_CASE("a slice is short for a slow device, and shrinks with what is left down to a shortest time") {
    SampleSlices slices({0, 100000}, 2, 16, 0);
    CHECK(slices.take(0, kNoLimit)->count() == 16);
    const double fast = 10000, slow = 100;
    CHECK(slices.take(fast, kNoLimit)->count() == static_cast<uint32_t>(fast * kSliceSeconds));
    CHECK(slices.take(slow, kNoLimit)->count() == static_cast<uint32_t>(slow * kSliceSeconds));
    uint32_t before = 1u << 31, last = 0;
    for (uint32_t left = 0; !slices.is_empty(); before = last) {
        left = 100000 - slices.handed_out();
        last = slices.take(fast, kNoLimit)->count();
        CHECK(last <= before);
        CHECK(last <= std::max(left / 8, static_cast<uint32_t>(fast * kLeastSliceSeconds)));
    }
    CHECK(last <= static_cast<uint32_t>(fast * kLeastSliceSeconds));
    SampleSlices few({0, 10}, 2, 16, 0);
    CHECK(few.take(0.001, kNoLimit)->count() == 1); // a sample of 1000 s
    CHECK(few.take(slow, 0.02)->count() == 1);      // a time limit
    CHECK(few.take(0, kNoLimit)->count() == 8);     // no more than there are
}

TEST_CASE("lost samples are handed out again, even after the end, and new ones are not") {
    SampleSlices slices({0, 100}, 2, 10, 10);
    REQUIRE(slices.take(0, kNoLimit) == SampleRange{0, 10});
    REQUIRE(slices.take(0, kNoLimit) == SampleRange{10, 20});
    slices.end();
    CHECK(slices.is_empty());
    CHECK(!slices.take(0, kNoLimit));
    slices.requeue({0, 10});
    slices.requeue({15, 15}); // nothing
    CHECK(!slices.is_empty());
    CHECK(slices.take(0, kNoLimit) == SampleRange{0, 10});
    CHECK(slices.is_empty());
    CHECK(slices.handed_out() == 20);
    SampleSlices others({0, 100}, 2, 10, 0);
    REQUIRE(others.take(0, kNoLimit) == SampleRange{0, 10});
    others.requeue({0, 10});
    CHECK(others.take(10, kNoLimit) == SampleRange{0, 2}); // in pieces that fit the device
    CHECK(others.take(10, kNoLimit) == SampleRange{2, 4});
}
