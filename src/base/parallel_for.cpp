#include "base/parallel_for.h"

#include <immintrin.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#if !defined(PERTEV_STD_THREADS)
#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_invoke.h>
#include <oneapi/tbb/task_arena.h>
#endif

namespace pertev {
namespace {

constexpr unsigned kDefaultControl = 0x1f80; // all exceptions masked, round to nearest, no FTZ, no DAZ

class DefaultFloatingPoint {
public:
    DefaultFloatingPoint() : saved_(_mm_getcsr()) { _mm_setcsr(kDefaultControl); }
    ~DefaultFloatingPoint() { _mm_setcsr(saved_); }
    DefaultFloatingPoint(const DefaultFloatingPoint&) = delete;
    DefaultFloatingPoint& operator=(const DefaultFloatingPoint&) = delete;

private:
    unsigned saved_;
};

int hardware_threads() { return std::max(1, static_cast<int>(std::thread::hardware_concurrency())); }

std::atomic<int> g_threads{0};

} // namespace

int thread_count() {
    const int count = g_threads.load();
    return count > 0 ? count : hardware_threads();
}

#if defined(PERTEV_STD_THREADS)

void set_thread_count(int count) { g_threads = count; }

void parallel_for_ranges(uint64_t count, uint64_t grain, const std::function<void(uint64_t, uint64_t)>& body) {
    if (count == 0) return;
    grain = std::max<uint64_t>(grain, 1);
    const uint64_t ranges = (count + grain - 1) / grain;
    const uint64_t workers = std::min<uint64_t>(static_cast<uint64_t>(thread_count()), ranges);
    std::atomic<uint64_t> next{0};
    std::exception_ptr error;
    std::mutex error_mutex;
    const auto work = [&] {
        const DefaultFloatingPoint control;
        for (uint64_t range = next++; range < ranges; range = next++) {
            try {
                body(range * grain, std::min(count, (range + 1) * grain));
            } catch (...) {
                const std::lock_guard lock(error_mutex);
                if (!error) error = std::current_exception();
                next = ranges;
            }
        }
    };
    std::vector<std::thread> threads;
    for (uint64_t i = 1; i < workers; ++i) threads.emplace_back(work);
    work();
    for (std::thread& thread : threads) thread.join();
    if (error) std::rethrow_exception(error);
}

void parallel_invoke(const std::function<void()>& a, const std::function<void()>& b) {
    // Nested calls of a recursive builder would start a thread each; a bound on how many keeps that sane.
    static std::atomic<int> running{0};
    if (running.fetch_add(1) >= thread_count() - 1) {
        running.fetch_sub(1);
        const DefaultFloatingPoint control;
        a();
        b();
        return;
    }
    std::exception_ptr error;
    std::thread other([&] {
        const DefaultFloatingPoint control;
        try {
            b();
        } catch (...) {
            error = std::current_exception();
        }
    });
    std::exception_ptr own_error;
    try {
        const DefaultFloatingPoint control;
        a();
    } catch (...) {
        own_error = std::current_exception();
    }
    other.join();
    running.fetch_sub(1);
    if (own_error) std::rethrow_exception(own_error);
    if (error) std::rethrow_exception(error);
}

#else

namespace {
std::unique_ptr<tbb::global_control> g_control;
} // namespace

void set_thread_count(int count) {
    g_threads = count;
    g_control.reset();
    // TBB's default arena has a slot a hardware thread; a larger count only over-subscribes if asked for.
    g_control = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                                      static_cast<std::size_t>(thread_count()));
}

void parallel_for_ranges(uint64_t count, uint64_t grain, const std::function<void(uint64_t, uint64_t)>& body) {
    if (count == 0) return;
    grain = std::max<uint64_t>(grain, 1);
    tbb::parallel_for(tbb::blocked_range<uint64_t>(0, count, grain), [&](const tbb::blocked_range<uint64_t>& range) {
        const DefaultFloatingPoint control;
        body(range.begin(), range.end());
    });
}

void parallel_invoke(const std::function<void()>& a, const std::function<void()>& b) {
    tbb::parallel_invoke(
        [&] {
            const DefaultFloatingPoint control;
            a();
        },
        [&] {
            const DefaultFloatingPoint control;
            b();
        });
}

#endif

} // namespace pertev
