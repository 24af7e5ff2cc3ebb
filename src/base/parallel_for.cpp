#include "base/parallel_for.h"

#include <immintrin.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <memory>
#include <mutex>
#include <thread>
#include <utility>
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

#if defined(PERTEV_STD_THREADS)

} // namespace

/// The threads that work for some threads.
struct ThreadTeam {
    explicit ThreadTeam(int threads) : count(threads) {}
    int count;                   // 0: one per hardware thread
    std::atomic<int> helpers{0}; // helpers of parallel_invoke, because nested calls of a recursive builder would
                                 // start a thread each
};

namespace {

/// The team of this thread, or of the one that it helps; null: one per hardware thread.
thread_local std::shared_ptr<ThreadTeam> t_team;

ThreadTeam& team() {
    if (t_team == nullptr) t_team = std::make_shared<ThreadTeam>(0);
    return *t_team;
}

} // namespace

int thread_count() { return team().count > 0 ? team().count : hardware_threads(); }

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
    for (uint64_t i = 1; i < workers; ++i) {
        threads.emplace_back([&work, of = t_team] {
            t_team = of;
            work();
        });
    }
    work();
    for (std::thread& thread : threads) thread.join();
    if (error) std::rethrow_exception(error);
}

void parallel_invoke(const std::function<void()>& a, const std::function<void()>& b) {
    std::atomic<int>& helpers = team().helpers;
    if (helpers.fetch_add(1) >= thread_count() - 1) {
        helpers.fetch_sub(1);
        const DefaultFloatingPoint control;
        a();
        b();
        return;
    }
    std::exception_ptr error;
    std::thread other([&, of = t_team] {
        t_team = of;
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
    helpers.fetch_sub(1);
    if (own_error) std::rethrow_exception(own_error);
    if (error) std::rethrow_exception(error);
}

#else

constexpr std::size_t kMaxThreads = 4096;
// An exception beside a call does not cancel it. TBB would let the call return as if it had done its work.
constexpr auto kIsolated = tbb::task_group_context::isolated;

} // namespace

/// The threads that work for some threads, separate from those of others.
struct ThreadTeam {
    explicit ThreadTeam(int threads) : count(threads), arena(threads) {
        // TBB has one worker less than hardware threads unless it is allowed more. Of several such permissions the
        // least counts, so there is one.
        if (count <= hardware_threads()) return;
        static const tbb::global_control permit(tbb::global_control::max_allowed_parallelism, kMaxThreads);
    }
    int count;
    tbb::task_arena arena;
};

namespace {

/// Null: one per hardware thread, or the team in which the thread works.
thread_local std::shared_ptr<ThreadTeam> t_team;

template <class Work>
void run_in_team(const Work& work) {
    if (t_team == nullptr) return work();
    t_team->arena.execute(work);
}

} // namespace

int thread_count() {
    return t_team != nullptr ? t_team->arena.max_concurrency() : tbb::this_task_arena::max_concurrency();
}

void parallel_for_ranges(uint64_t count, uint64_t grain, const std::function<void(uint64_t, uint64_t)>& body) {
    if (count == 0) return;
    const tbb::blocked_range<uint64_t> all(0, count, std::max<uint64_t>(grain, 1));
    run_in_team([&] {
        tbb::task_group_context own(kIsolated);
        const auto work = [&](const tbb::blocked_range<uint64_t>& range) {
            const DefaultFloatingPoint control;
            body(range.begin(), range.end());
        };
        tbb::parallel_for(all, work, own);
    });
}

void parallel_invoke(const std::function<void()>& a, const std::function<void()>& b) {
    const auto guarded = [](const std::function<void()>& work) {
        return [&work] {
            const DefaultFloatingPoint control;
            work();
        };
    };
    run_in_team([&] {
        tbb::task_group_context own(kIsolated);
        tbb::parallel_invoke(guarded(a), guarded(b), own);
    });
}

#endif

Threads::Threads() {
    if (t_team != nullptr && t_team->count > 0) team_ = t_team;
}

Threads::Threads(int count) : team_(count > 0 ? std::make_shared<ThreadTeam>(count) : nullptr) {}

UseThreads::UseThreads(const Threads& threads) : own_(std::exchange(t_team, threads.team_)) {}
UseThreads::~UseThreads() { t_team = std::move(own_); }

} // namespace pertev
