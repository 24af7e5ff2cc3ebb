// The emulated warp of kernel tests: warp operations behave as CUDA specifies, __activemask() returns any permitted
// mask, and faulty kernels are reported with their fault.

#include "tests/support/emulated_warp.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <set>
#include <vector>

#include "tests/support/options.h"
#include "tests/support/random.h"

using namespace pertev::test;

namespace {

constexpr uint32_t kWarp = 0xffffffffu;

uint32_t me() { return lane::thread_index.x & 31u; }
uint32_t my_bit() { return 1u << me(); }
uint32_t seeds() { return static_cast<uint32_t>(effort(100, 5000)); }

/// Returns the result of run_warps for a kernel of one warp, which must be the same for each schedule.
template <class Kernel>
std::set<std::string> headlines(const Kernel& kernel) {
    std::set<std::string> faults;
    for (uint32_t seed = 0; seed < seeds(); ++seed) {
        const std::string fault = run_warps({.seed = seed, .max_steps = 10'000}, kernel);
        faults.insert(fault.substr(0, fault.find('\n')));
    }
    return faults;
}

/// Returns whether each run's fault contains all of these words.
template <class Kernel>
bool says(const Kernel& kernel, const std::vector<std::string>& words) {
    for (uint32_t seed = 0; seed < seeds(); ++seed) {
        const std::string fault = run_warps({.seed = seed, .max_steps = 10'000}, kernel);
        const auto is_there = [&](const std::string& word) { return fault.find(word) != fault.npos; };
        if (std::all_of(words.begin(), words.end(), is_there)) continue;
        MESSAGE("seed ", seed, ": ", fault);
        return false;
    }
    return true;
}

} // namespace

TEST_CASE("each thread of a launch runs once, with its own indices") {
    for (uint32_t seed = 0; seed < seeds(); ++seed) {
        std::vector<int> runs(3 * 128);
        const std::string fault = run_warps({.blocks = 3, .threads = 128, .seed = seed}, [&] {
            ++runs[lane::block_index.x * lane::block_size.x + lane::thread_index.x];
            lane::step();
        });
        REQUIRE(fault == "");
        REQUIRE(std::all_of(runs.begin(), runs.end(), [](int n) { return n == 1; }));
    }
}

TEST_CASE("a launch of no threads runs none") {
    CHECK(run_warps({.blocks = 0}, [] { FAIL("ran"); }) == "");
}

TEST_CASE("warp operations give each lane CUDA's result, whichever lane arrives first") {
    for (uint32_t seed = 0; seed < seeds(); ++seed) {
        std::vector<int> wrong(32);
        const std::string fault = run_warps({.seed = seed}, [&] {
            const uint32_t k = me(), odd = 0xaaaaaaaau, mine = k % 2 == 1 ? odd : ~odd;
            wrong[k] += lane::ballot(kWarp, k % 3 == 0) != 0x49249249u;
            wrong[k] += lane::ballot(mine, k < 8) != (mine & 0xffu); // two halves, each separately
            wrong[k] += !lane::all(mine, (mine >> k & 1) != 0);
            wrong[k] += lane::all(kWarp, k != 17);
            wrong[k] += lane::match_any(kWarp, uint64_t(k / 8) << 40) != 0xffu << (k / 8 * 8);
            wrong[k] += lane::shuffle(kWarp, 100 + k, 5) != 105;
            lane::sync(kWarp);
            if (k >= 20) wrong[k] += lane::ballot(0xfff00000u, true) != 0xfff00000u;
            wrong[k] += lane::ballot(my_bit(), true) != my_bit();
            lane::step();
            wrong[k] += me() != k;
        });
        REQUIRE(fault == "");
        REQUIRE(std::count(wrong.begin(), wrong.end(), 0) == 32);
    }
}

TEST_CASE("no lane passes a warp operation before the last one has reached it") {
    for (uint32_t seed = 0; seed < seeds(); ++seed) {
        int here = 0, early = 0;
        const std::string fault = run_warps({.seed = seed}, [&] {
            for (uint32_t i = 0; i < me(); ++i) lane::step();
            ++here;
            lane::sync(kWarp);
            early += here < 32 ? 1 : 0;
        });
        REQUIRE(fault == "");
        REQUIRE(early == 0);
    }
}

TEST_CASE("lanes at one call get the same active mask, which holds all or some of them and varies") {
    bool once_whole = false, once_single = false, once_between = false;
    for (uint32_t seed = 0; seed < seeds(); ++seed) {
        std::vector<uint32_t> first(32), second(32);
        const auto ask = [] { return lane::active_mask(); }; // these are two calls on one source line
        const std::string fault = run_warps({.seed = seed}, [&] {
            if (me() < 12) {
                first[me()] = ask();
                lane::step();
            } else { // the branches differ in order, so that the compiler does not merge the two calls
                lane::step();
                second[me()] = ask();
            }
        });
        REQUIRE(fault == "");
        for (uint32_t k = 0; k < 32; ++k) {
            const uint32_t mask = first[k] | second[k];
            REQUIRE((mask >> k & 1) != 0);
            REQUIRE((mask & ~(k < 12 ? 0xfffu : ~0xfffu)) == 0);
            for (uint32_t j = 0; j < 32; ++j) {
                if ((mask >> j & 1) != 0) REQUIRE((first[j] | second[j]) == mask);
            }
            once_whole |= mask == 0xfffu;
            once_single |= mask == 1u << k;
            once_between |= mask != 1u << k && mask != 0xfffu && mask != ~0xfffu;
        }
    }
    CHECK(once_whole);
    CHECK(once_single);
    CHECK(once_between);
}

TEST_CASE("warps alternate in some runs and follow each other in others") {
    bool mixed = false, in_a_row = false;
    for (uint32_t seed = 0; seed < seeds(); ++seed) {
        std::vector<uint32_t> order;
        const std::string fault = run_warps({.blocks = 2, .threads = 64, .seed = seed}, [&] {
            for (int i = 0; i < 3; ++i) {
                lane::sync(kWarp);
                if (me() == 0) order.push_back(lane::block_index.x * 2 + lane::thread_index.x / 32);
            }
        });
        REQUIRE(fault == "");
        REQUIRE(order.size() == 12);
        int changes = 0;
        for (std::size_t i = 1; i < order.size(); ++i) changes += order[i] != order[i - 1] ? 1 : 0;
        mixed |= changes > 5;
        in_a_row |= changes == 3;
    }
    CHECK(mixed);
    CHECK(in_a_row);
}

TEST_CASE("equal seeds give equal runs") {
    const auto run = [](uint32_t seed) {
        std::vector<uint32_t> order;
        run_warps({.blocks = 2, .threads = 64, .seed = seed}, [&] {
            order.push_back(lane::active_mask());
            lane::step();
            order.push_back(lane::thread_index.x);
        });
        return order;
    };
    CHECK(run(7) == run(7));
    CHECK(run(7) != run(8));
}

TEST_CASE("a lane that ended while others wait for it is a fault that names it") {
    const auto kernel = [] {
        if (me() == 3) return;
        lane::ballot(kWarp, true);
    };
    CHECK(headlines(kernel) == std::set<std::string>{"no lane can go on"});
    CHECK(says(kernel, {"lanes 0-2, 4-31 wait at __ballot_sync of mask 0xffffffff, tests/unit/emulated_warp_test.cpp:",
                        "lanes 3 of it have ended"}));
}

TEST_CASE("a lane that waits at another operation while others wait for it is a fault") {
    CHECK(says(
        [] {
            if (me() < 30) {
                lane::ballot(kWarp, true);
            } else {
                lane::sync(kWarp);
            }
        },
        {"no lane can go on", "lanes 0-29 wait at __ballot_sync", "lanes 30-31 of it are elsewhere",
         "lanes 30-31 wait at __syncwarp"}));
}

TEST_CASE("lanes of one mask that pass different masks are a fault") {
    CHECK(says([] { lane::ballot(me() == 9 ? 0x00000300u : kWarp, true); },
               {"no lane can go on", "of mask 0xffffffff", "lanes 9 of it name another mask", "of mask 0x300",
                "lanes 8 of it name another mask"}));
}

TEST_CASE("a lane that passes a mask without itself, or reads a lane outside of it, is a fault") {
    CHECK(says([] { lane::sync(me() == 31 ? 0x7fffffffu : kWarp); }, {"a lane names a mask without itself"}));
    CHECK(says([] { lane::shuffle(me() < 16 ? 0xffffu : 0xffff0000u, 1, 16); },
               {"a lane asks for the value of one that its mask does not name"}));
}

TEST_CASE("a mask read before lanes diverged is a fault where it is used") {
    // Some schedules let the fault pass, as a GPU does, but not all may.
    bool noticed = false;
    for (uint32_t seed = 0; seed < seeds(); ++seed) {
        noticed |= run_warps({.seed = seed}, [] {
                       const uint32_t lanes = lane::active_mask();
                       if (me() % 2 == 0) lane::ballot(lanes, true);
                   }) != "";
    }
    CHECK(noticed);
}

TEST_CASE("lanes that wait for each other in an endless loop are a fault") {
    CHECK(says(
        [] {
            while (lane::ballot(kWarp, true) != 0) {
            }
        },
        {"no end after 10000 steps", "__ballot_sync"}));
}

TEST_CASE("a run after a fault behaves like the first one") {
    CHECK(run_warps({.blocks = 5, .threads = 64}, [] {
              if (me() != 3) lane::sync(kWarp);
          }) != "");
    CHECK(run_warps({.blocks = 5, .threads = 64}, [] { lane::sync(kWarp); }) == "");
}
