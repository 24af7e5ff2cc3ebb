#pragma once

// A call of RenderOnDevices::render: the state that the threads of its devices share with the caller's thread.
// A device takes slices into a film of its own and hands that over now and then; the caller adds it to the sum. Samples
// in films that were not yet added are lost with their device, and the others render them again.

#include <atomic>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <optional>
#include <vector>

#include "base/stopwatch.h"
#include "session/devices/sample_slices.h"
#include "settings/render_settings.h"

namespace pertev {

/// Samples in a film of a device that are not in the sum.
struct FilledFilm {
    std::size_t device = 0;
    Film* film = nullptr;
    std::vector<SampleRange> slices;
    uint32_t done = 0; // samples; fewer than in the slices while one is under way
    RayCounts rays;

    uint32_t samples() const;
};

/// The progress of a run.
struct RunState {
    uint32_t done = 0;     // samples in all films
    double made_share = 1; // share of the slowest integrator's precomputation
    double seconds = 0, made_seconds = 0;
    RayCounts rays; // rays of the samples in the sum
};

class SharedRun {
public:
    SharedRun(SampleRange range, const RenderSettings& settings, std::size_t devices);

    // The devices call these.

    /// Starts the clock of the time limit, unless another device has.
    void start_clock();
    /// Reports the share of its precomputation that a device has done. Returns whether it goes on.
    bool goes_on_making(std::size_t device, double share);
    /// Returns a slice for a device that takes `rate` samples per second, 0 if that is unknown; nothing if there is
    /// none at present.
    std::optional<SampleRange> take(std::size_t device, double rate);
    void add_done(uint32_t samples);
    /// Submits a film, which is then added to the sum and cleared. Waits until `next` is clear.
    void submit(FilledFilm film, const Film* next);
    /// Waits until there may be a slice. Returns false at the end, or if the device is lost.
    bool wait_for_work(std::size_t device);
    /// Gives the device up, with samples that it has not handed over.
    void lose(const FilledFilm& unsaved, const Error& why);
    /// Ends the run because of what no other device could do better.
    void fail(std::exception_ptr why);
    /// Ends a device's part.
    void leave();
    bool is_lost(std::size_t device) const;
    /// Returns whether everything that was rendered is dropped. It is cheap.
    bool is_dropped() const { return is_dropped_; }

    // The caller calls these.

    /// Returns a film to be added; nothing after `most_s` seconds, if all devices have left, or, if `has_films`, which
    /// are not in the sum yet, once no device is at work.
    std::optional<FilledFilm> wait_for_film(double most_s, bool has_films);
    void add_to_sum(const FilledFilm& film);
    /// Lets the device use the film again.
    void release(const FilledFilm& film);
    /// Hands out no new samples; if `drops` and there is no whole slice yet, ends those under way.
    void stop(bool drops);
    bool have_all_left() const;
    /// Returns whether devices are at work on their last slices, and none of them was lost.
    bool is_ending() const;
    RunState state() const;
    /// Returns the errors of lost devices since the last call.
    std::vector<std::pair<std::size_t, Error>> take_losses();
    /// Returns the number of samples in the sum, consecutive from the first on. Throws why the run failed, or that no
    /// device is left.
    uint32_t result();
    double first_seconds() const { return first_seconds_; }
    /// Seconds of the clock when the last slice was done.
    double last_slice_seconds() const { return last_slice_seconds_; }

private:
    bool is_finished() const { return slices_.is_empty() && in_sum_ == slices_.handed_out(); }
    bool is_busy(const Film* film) const;
    bool is_idle() const { return waiting_ + left_ == is_lost_.size(); }

    mutable std::mutex mutex_;
    std::condition_variable changed_;
    SampleSlices slices_;
    double time_limit_s_;
    std::optional<Stopwatch> clock_;
    std::vector<FilledFilm> full_;  // to be added, in the order of their arrival
    std::vector<const Film*> busy_; // handed over and not yet released
    std::vector<bool> is_lost_;
    std::vector<double> made_shares_; // 1 once a device has begun samples
    double made_seconds_ = 0;
    std::vector<std::pair<std::size_t, Error>> losses_;
    std::optional<Error> first_loss_;
    std::exception_ptr failure_;
    std::size_t left_ = 0, waiting_ = 0; // devices that have left, and that wait
    uint32_t done_ = 0, in_sum_ = 0;
    RayCounts rays_;
    double first_seconds_ = 0, last_slice_seconds_ = 0;
    std::atomic<bool> is_dropped_ = false; // no device goes on, because the caller ended the run or it failed
};

} // namespace pertev
