#pragma once

// TwoSchedules is the shell of an integrator whose stages run by either of two schedules, which give the same bytes. In
// the loop each thread of the CPU takes some samples through all stages, in memory that its cache holds. It needs a
// tracer whose trees the host can traverse. In the wavefront every stage runs over all samples in flight, and the
// scene's tracer traces their rays. The order of the stages is written once, as a template over the schedule.
//
// The stages get a `Job` of views and numbers. It names its parts:
//   Capacity           the sizes of its arrays, for `count` samples
//   Counts             the counts of rays, to which counts() points
//   Loop, Wavefront    the schedules: LoopSchedule and WavefrontSchedule with functions that trace the job's rays
//   first, count       the range of samples that runs
// lay_out(job, memory, capacity) places its arrays (lay_out_arrays), and rays_of(counts) returns the rays of a range.

#include <algorithm>
#include <vector>

#include "base/error.h"
#include "device/launch.h"
#include "device/readback.h"
#include "integrators/integrator_base.h"
#include "math/float4.h"

namespace pertev {

template <class Counts>
class WavefrontSchedule {
public:
    static constexpr bool kIsLoop = false;
    WavefrontSchedule(Queue& queue, SceneTracer& tracer, Readback<Counts>& seen)
        : queue_(queue), tracer_(tracer), seen_(seen) {}

    template <class Stage>
    void run(const char* name, WorkCount count, const Stage& stage) {
        launch(queue_, name, count, stage);
    }
    /// Sets the bound of the first round's rays.
    void begin_rounds(uint32_t most) {
        if (is_pending_) seen_.wait();
        is_pending_ = false;
        max_ = most;
    }
    uint32_t max_rays() const { return max_; }
    /// Returns false once no ray is left. The host launches rounds without a wait and reads the count one round late.
    bool has_rays_left(const Counts* counts) {
        if (is_pending_) max_ = seen_.wait().rays;
        is_pending_ = max_ > 0;
        if (is_pending_) seen_.take(counts);
        return is_pending_;
    }

protected:
    Queue& queue_;
    SceneTracer& tracer_;

private:
    Readback<Counts>& seen_;
    bool is_pending_ = false;
    uint32_t max_ = 0;
};

/// Runs the stages in one thread.
template <class Counts>
class LoopSchedule {
public:
    static constexpr bool kIsLoop = true;
    explicit LoopSchedule(const HostTrees& trees) : trees_(trees) {}

    template <class Stage>
    void run(const char*, WorkCount count, const Stage& stage) {
        for (uint32_t i = 0; i < count.value(); ++i) stage(i);
    }
    void begin_rounds(uint32_t most) { max_ = most; }
    uint32_t max_rays() const { return max_; }
    bool has_rays_left(const Counts* counts) {
        max_ = counts->rays;
        return max_ > 0;
    }

protected:
    const HostTrees& trees_;

private:
    uint32_t max_ = 0;
};

template <class Settings, class Job>
class TwoSchedules : public IntegratorBase<Settings> {
    using Base = IntegratorBase<Settings>;

public:
    using Capacity = typename Job::Capacity;
    using Counts = typename Job::Counts;

    /// Makes an integrator whose wavefront takes at most kMaxBytes.
    TwoSchedules(Queue& queue, const Settings& settings, bool in_loop, uint32_t batch)
        : Base(queue, settings, in_loop, batch), seen_(queue) {}

protected:
    using Base::kLoopCount, Base::queue_, Base::rays_, Base::tracer_;
    static constexpr std::size_t kMaxBytes = std::size_t(1) << 30; // maximum bytes on a device
    static constexpr uint32_t kMinCount = 32;                      // minimum number of samples in memory

    static std::size_t bytes_of(const Capacity& capacity) {
        Job job = {};
        return lay_out(job, nullptr, capacity);
    }
    /// Returns the capacity for as many samples as fit into `bytes`, at most `most` and at least kMinCount.
    /// capacity_of(n) is the capacity for n samples.
    template <class CapacityOf>
    static Capacity capacity_within(std::size_t bytes, uint64_t most, const CapacityOf& capacity_of) {
        const std::size_t each = bytes_of(capacity_of(kMinCount)) / kMinCount;
        return capacity_of(
            static_cast<uint32_t>(std::min<uint64_t>(most, std::max<uint64_t>(bytes / each, kMinCount))));
    }

    /// Takes the memory of the wavefront.
    void allocate_capacity(const Capacity& capacity, const char* name) {
        capacity_ = capacity;
        memory_.grow(queue_, bytes_of(capacity), name);
    }
    /// Points the arrays of `job` into the wavefront's memory.
    void lay_out_job(Job& job) const { lay_out(job, memory_.data(), capacity_); }

    /// The memory and the schedule of a thread of the loop.
    class Thread {
        std::vector<Float4> memory;

    public:
        typename Job::Loop schedule;

        Thread(const HostTrees& trees, Job& job, const Capacity& capacity)
            : memory(bytes_of(capacity) / sizeof(Float4) + 1), schedule(trees, begun(job, capacity)) {}

    private:
        const Job& begun(Job& job, const Capacity& capacity) {
            lay_out(job, reinterpret_cast<std::byte*>(memory.data()), capacity);
            *job.counts() = {};
            return job;
        }
    };
    /// Calls run(schedule, job) with ranges of [begin, end) of at most `at_once` samples.
    template <class Schedule, class Run>
    static void run_in_parts(Schedule& schedule, Job& job, uint64_t begin, uint64_t end, uint32_t at_once,
                             const Run& run) {
        for (job.first = begin; job.first < end; job.first += at_once) {
            job.count = static_cast<uint32_t>(std::min<uint64_t>(at_once, end - job.first));
            run(schedule, job);
        }
    }
    /// Calls run(schedule, job) with ranges of samples [begin, end) that fit into the memory, by the schedule of the
    /// current picture. The range has `of_pixel` samples of each pixel. `loop_capacity` is the room of a thread. Counts
    /// all rays but those of the camera.
    template <class Run>
    void run_stages(const Job& job, uint64_t begin, uint64_t end, const Capacity& loop_capacity, uint32_t of_pixel,
                    const Run& run) {
        if (begin >= end) return;
        Job part = job;
        if (const HostTrees* trees = Base::trees_of_loop()) {
            Base::trace_ranges(end - begin, uint64_t(kLoopCount) * of_pixel, [&](uint64_t from, uint64_t to) {
                Job own = job;
                Thread thread(*trees, own, loop_capacity);
                run_in_parts(thread.schedule, own, begin + from, begin + to, loop_capacity.count, run);
                return rays_of(*own.counts());
            });
            return;
        }
        lay_out_job(part);
        queue_.zero(part.counts(), sizeof(Counts));
        typename Job::Wavefront schedule(queue_, *tracer_, seen_);
        run_in_parts(schedule, part, begin, end, capacity_.count, run);
        schedule.begin_rounds(0);
        Counts counts;
        queue_.copy_to_host(&counts, part.counts(), sizeof counts);
        rays_ = rays_ + rays_of(counts);
    }

    Capacity capacity_{}; // sizes of the wavefront
    Readback<Counts> seen_;

private:
    Buffer<std::byte> memory_;
};

} // namespace pertev
