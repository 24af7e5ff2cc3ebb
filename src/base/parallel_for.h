#pragma once

// Runs body(i) for each i in [0, count), in no fixed order, on the threads that work for the caller (UseThreads). The
// body runs with the processor's default floating-point control register (round to nearest, no flush to zero),
// whatever the caller's; that is restored. An exception thrown by the body is rethrown by the call. Backends: oneTBB,
// or std::thread (PERTEV_THREADS=STD) for ThreadSanitizer, for which Debian's TBB is not instrumented.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>

namespace pertev {

/// Returns how many threads work for the calling thread.
int thread_count();

struct ThreadTeam;
/// Threads that work together. Copies share them.
class Threads {
public:
    /// Takes the threads that work for the calling thread; at first one per hardware thread.
    Threads();
    /// Takes `count` new threads; 0 means one per hardware thread.
    explicit Threads(int count);

private:
    friend class UseThreads;
    std::shared_ptr<ThreadTeam> team_; // null: one per hardware thread
};
/// While it exists, these threads work for the calling thread in place of its own.
class UseThreads {
public:
    explicit UseThreads(const Threads& threads);
    explicit UseThreads(int count) : UseThreads(Threads(count)) {}
    ~UseThreads();
    UseThreads(const UseThreads&) = delete;
    UseThreads& operator=(const UseThreads&) = delete;

private:
    std::shared_ptr<ThreadTeam> own_;
};

/// Runs body(begin, end) over disjoint ranges of at least `grain` indices that cover [0, count).
void parallel_for_ranges(uint64_t count, uint64_t grain, const std::function<void(uint64_t, uint64_t)>& body);

/// Runs `a` and `b`, possibly concurrently, and returns when both are done.
void parallel_invoke(const std::function<void()>& a, const std::function<void()>& b);

template <class Body>
void parallel_for(uint64_t count, uint64_t grain, const Body& body) {
    parallel_for_ranges(count, grain, [&](uint64_t begin, uint64_t end) {
        for (uint64_t i = begin; i < end; ++i) body(i);
    });
}

} // namespace pertev
