#pragma once

// This base class holds what every integrator has: its settings, the current picture and its tracer, the count of rays,
// and the sink that may stop a render. Most integrators have a second schedule, the loop, in which each thread of the
// CPU renders samples of its own (integrators/two_schedules.h).

#include <atomic>

#include "base/error.h"
#include "base/parallel_for.h"
#include "device/launch.h"
#include "integrators/integrator.h"

namespace pertev {

template <class Settings>
class IntegratorBase : public Integrator {
public:
    /// Makes an integrator; `queue` outlives it. `in_loop` requests the loop, which runs if the tracer has host trees.
    /// `batch` limits the samples in flight of a wavefront.
    explicit IntegratorBase(Queue& queue, const Settings& settings, bool in_loop = false, uint32_t batch = 0)
        : queue_(queue), settings_(settings), picture_settings_(settings), batch_(batch), in_loop_(in_loop) {}

    void begin(const PictureView& picture, SceneTracer& tracer, uint32_t samples) override {
        picture_ = picture;
        tracer_ = &tracer;
        rays_ = {};
        picture_settings_ = settings_;
        reserve(size_of(picture, tracer, samples));
    }
    void stop_with(Sink* sink) override { sink_ = sink; }
    RayCounts rays() const override { return rays_; }

    /// Changes the settings at the next begin().
    void set_settings(const Settings& settings) { settings_ = settings; }

protected:
    bool uses_loop(const WorkSize& size) const { return in_loop_ && size.traverses_on_host; }
    /// Returns the trees that the loop traverses for the current picture, or null if it does not run by the loop.
    const HostTrees* trees_of_loop() const { return in_loop_ ? tracer_->host_trees() : nullptr; }
    /// Returns what may end render() early.
    Sink& stopping_sink() const { return sink_ != nullptr ? *sink_ : nobody(); }
    bool is_abandoned() const { return stopping_sink().should_stop(); }
    /// Throws std::logic_error unless `film` lies in the picture.
    void check_window(const FilmView& film) const {
        PERTEV_CHECK(film.window.is_in(picture_.camera.width, picture_.camera.height));
    }
    /// Throws std::logic_error unless `film` lies in the picture, and if it is a frame.
    void check_sums(const FilmView& film) const {
        PERTEV_CHECK(!film.frame.is_there());
        check_window(film);
    }

    /// Launches a stage, with one call per pixel, for the pixels of its film.
    template <class Stage>
    void launch_for_pixels(const char* name, const Stage& stage) {
        const PixelWindow& window = stage.film.window;
        launch(queue_, name, window.count(), InWindow<Stage>{stage, window});
    }

    static constexpr uint32_t kLoopCount = 256; // minimum number of pixels that a thread of the loop takes at once
    /// Calls work(begin, end) with ranges of [0, count) on all threads and adds up the rays that the calls return.
    template <class Work>
    void trace_ranges(uint64_t count, uint64_t least, const Work& work) {
        const UseThreads use(queue_.threads());
        std::atomic<uint64_t> bounces{0}, shadows{0};
        parallel_for_ranges(count, least, [&](uint64_t begin, uint64_t end) {
            const RayCounts traced = work(begin, end);
            bounces += traced.bounce;
            shadows += traced.shadow;
        });
        rays_ = rays_ + RayCounts{0, bounces, shadows};
    }

    Queue& queue_;
    Settings settings_, picture_settings_; // settings of the next begin(), and of the current picture
    uint32_t batch_;
    PictureView picture_{};
    SceneTracer* tracer_ = nullptr;
    RayCounts rays_;

private:
    bool in_loop_;
    Sink* sink_ = nullptr;
};

} // namespace pertev
