#include "session/devices/shared_run.h"

#include <algorithm>
#include <chrono>
#include <limits>
#include <utility>

#include "base/error.h"

namespace pertev {
namespace {

constexpr uint32_t kFirstSlice = 16; // samples of a first slice at most

uint32_t first_count(const RenderSettings& settings) {
    const uint64_t pixels = settings.window().count();
    return settings.time_limit_s > 0 ? 1 : std::min(samples_at_once(settings, pixels), kFirstSlice);
}

} // namespace

uint32_t FilledFilm::samples() const {
    uint32_t count = 0;
    for (const SampleRange& slice : slices) count += slice.count();
    return count;
}

SharedRun::SharedRun(SampleRange range, const RenderSettings& settings, std::size_t devices)
    : slices_(range, devices, first_count(settings), settings.pass_samples), time_limit_s_(settings.time_limit_s),
      is_lost_(devices), made_shares_(devices, 1.0) {}

void SharedRun::start_clock() {
    const std::lock_guard lock(mutex_);
    if (!clock_) clock_.emplace();
}

bool SharedRun::goes_on_making(std::size_t device, double share) {
    const std::lock_guard lock(mutex_);
    made_shares_[device] = share;
    made_seconds_ = clock_->seconds();
    const bool is_over = time_limit_s_ > 0 && made_seconds_ >= time_limit_s_;
    return !is_over && !is_dropped_ && !slices_.is_empty();
}

std::optional<SampleRange> SharedRun::take(std::size_t device, double rate) {
    const std::lock_guard lock(mutex_);
    made_shares_[device] = 1;
    if (is_dropped_ || is_lost_[device]) return std::nullopt;
    double most_s = std::numeric_limits<double>::infinity();
    if (time_limit_s_ > 0) {
        const double left = time_limit_s_ - clock_->seconds();
        if (left <= 0 && slices_.handed_out() > 0) slices_.end();
        if (left > 0) most_s = left; // lost samples take their time
    }
    return slices_.take(rate, most_s);
}

void SharedRun::add_done(uint32_t samples) {
    const std::lock_guard lock(mutex_);
    done_ += samples;
    last_slice_seconds_ = clock_->seconds();
    if (first_seconds_ == 0) first_seconds_ = last_slice_seconds_;
}

bool SharedRun::is_busy(const Film* film) const { return std::ranges::find(busy_, film) != busy_.end(); }

void SharedRun::submit(FilledFilm film, const Film* next) {
    std::unique_lock lock(mutex_);
    const std::size_t device = film.device;
    busy_.push_back(film.film);
    full_.push_back(std::move(film));
    ++waiting_;
    changed_.notify_all();
    changed_.wait(lock, [&] { return !is_busy(next) || is_dropped_ || is_lost_[device]; });
    --waiting_;
}

bool SharedRun::wait_for_work(std::size_t device) {
    std::unique_lock lock(mutex_);
    const auto ends = [&] { return is_dropped_ || is_lost_[device] || is_finished(); };
    ++waiting_;
    changed_.notify_all();
    const auto is_stuck = [&] { // no device is at work, so nothing would ever change
        return !ends() && slices_.is_empty() && is_idle() && busy_.empty();
    };
    changed_.wait(lock, [&] { return ends() || !slices_.is_empty() || is_stuck(); });
    PERTEV_CHECK(!is_stuck());
    --waiting_;
    return !ends();
}

void SharedRun::lose(const FilledFilm& unsaved, const Error& why) {
    const std::lock_guard lock(mutex_);
    for (const SampleRange& slice : unsaved.slices) slices_.requeue(slice);
    done_ -= unsaved.done;
    if (!is_lost_[unsaved.device]) losses_.emplace_back(unsaved.device, why);
    if (!first_loss_) first_loss_ = why;
    is_lost_[unsaved.device] = true;
    made_shares_[unsaved.device] = 1;
    changed_.notify_all();
}

void SharedRun::fail(std::exception_ptr why) {
    const std::lock_guard lock(mutex_);
    if (!failure_) failure_ = std::move(why);
    is_dropped_ = true;
    changed_.notify_all();
}

void SharedRun::leave() {
    const std::lock_guard lock(mutex_);
    ++left_;
    changed_.notify_all();
}

bool SharedRun::is_lost(std::size_t device) const {
    const std::lock_guard lock(mutex_);
    return is_lost_[device];
}

std::optional<FilledFilm> SharedRun::wait_for_film(double most_s, bool has_films) {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, std::chrono::duration<double>(most_s),
                      [&] { return !full_.empty() || left_ == is_lost_.size() || (has_films && is_idle()); });
    if (full_.empty()) return std::nullopt;
    FilledFilm film = std::move(full_.front());
    full_.erase(full_.begin());
    return film;
}

void SharedRun::add_to_sum(const FilledFilm& film) {
    const std::lock_guard lock(mutex_);
    in_sum_ += film.samples();
    rays_ = rays_ + film.rays;
    changed_.notify_all();
}

void SharedRun::release(const FilledFilm& film) {
    const std::lock_guard lock(mutex_);
    std::erase(busy_, film.film);
    changed_.notify_all();
}

void SharedRun::stop(bool drops) {
    const std::lock_guard lock(mutex_);
    if (drops && done_ == 0) {
        is_dropped_ = true;
    } else {
        slices_.end();
    }
    changed_.notify_all();
}

bool SharedRun::have_all_left() const {
    const std::lock_guard lock(mutex_);
    return left_ == is_lost_.size() && full_.empty();
}

bool SharedRun::is_ending() const {
    const std::lock_guard lock(mutex_);
    return slices_.is_empty() && !first_loss_ && !is_idle();
}

RunState SharedRun::state() const {
    const std::lock_guard lock(mutex_);
    RunState state;
    state.done = done_;
    state.made_share = *std::ranges::min_element(made_shares_);
    state.seconds = clock_ ? clock_->seconds() : 0;
    state.made_seconds = made_seconds_;
    state.rays = rays_;
    return state;
}

std::vector<std::pair<std::size_t, Error>> SharedRun::take_losses() {
    const std::lock_guard lock(mutex_);
    return std::exchange(losses_, {});
}

uint32_t SharedRun::result() {
    const std::lock_guard lock(mutex_);
    if (failure_) std::rethrow_exception(failure_);
    if (is_dropped_) return 0;
    const bool has_device = std::ranges::find(is_lost_, false) != is_lost_.end();
    if (in_sum_ != slices_.handed_out() || (in_sum_ == 0 && !has_device)) throw first_loss_.value();
    return in_sum_;
}

} // namespace pertev
