#include "session/devices/device_worker.h"

#include <algorithm>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "base/error.h"
#include "base/stopwatch.h"
#include "device/device_identity.h"
#include "render/sample_layers/variance_target.h"
#include "session/devices/one_device.h"

namespace pertev {
namespace {

/// Stops a CPU in a slice whose samples are dropped.
class DropSink final : public Sink {
public:
    explicit DropSink(const SharedRun& run) : run_(run) {}
    bool should_stop() override { return run_.is_dropped(); }

private:
    const SharedRun& run_;
};

bool film_is_like(const Film& film, const Film& other) {
    return std::ranges::equal(film.targets(), other.targets(),
                              [](const auto& a, const auto& b) { return a->is_like(*b); });
}

/// Copies a little to the host, because the first large copy of a queue pins memory, for which a GPU may pause.
void copy_once(const Film& film) {
    const FilmTarget& target = *film.targets().front();
    constexpr std::size_t kEnough = std::size_t(2) << 20;
    std::vector<std::byte> bytes(std::min(target.byte_count(), kEnough / target.stride() * target.stride()));
    target.read(0, bytes);
}

} // namespace

void stay_near(const Queue& queue) {
    if (!queue.is_cuda()) return;
    const std::vector<DeviceIdentity> identities = device_identities();
    const auto index = static_cast<std::size_t>(queue.device_index());
    if (index < identities.size()) stay_on_processors(processors_near(identities[index].bus));
}

std::string name_of_device(const Queue& queue) {
    return queue.is_cuda() ? fmt::format("cuda:{}", queue.device_index()) : "cpu";
}

std::string DeviceWorker::name() const { return name_of_device(queue_); }

void DeviceWorker::change_scene(const PreparedScene& scene, uint32_t parts) {
    if (own_scene_) own_scene_->change(scene, parts);
}

PictureRenderer& DeviceWorker::pictures_of(PictureRenderer& of_caller, const RenderSettings& settings) {
    return own_scene_ ? own_scene_->update(of_caller.scene(), settings) : of_caller;
}

/// Makes the films that fit the picture, or clears those that do.
void DeviceWorker::make_films(const SharedPicture& picture, const Film& into) {
    if (!film_queue_) film_queue_.emplace(another_queue(queue_));
    for (std::optional<Film>& film : films_) {
        const bool is_first = &film == &films_[0];
        if (film && !film_is_like(*film, into)) film.reset();
        try {
            Film& made = fit_film(*film_queue_, film, picture.settings, picture.add_targets);
            made.set_place_of(into);
            made.clear();
            if (queue_.is_cuda() && is_first) copy_once(made);
        } catch (const Error& error) {
            film.reset();
            if (is_first || error.code() != ErrorCode::OutOfMemory) throw;
        }
    }
    if (landing_ && !film_is_like(*landing_, into)) landing_.reset();
    if (!own_scene_ && films_[1]) {
        try {
            fit_film(*film_queue_, landing_, picture.settings, picture.add_targets);
        } catch (const Error& error) {
            if (error.code() != ErrorCode::OutOfMemory) throw;
        }
    }
    film_queue_->wait(); // the other queue of the device does not wait for this one
    held_ = {.device = number_, .film = &*films_[0], .slices = {}, .rays = {}};
}

void DeviceWorker::clear(Film& film) {
    film.clear();
    film_queue_->wait(); // before the other queue adds samples
}

bool DeviceWorker::add(Film& to, const Film& other) {
    if (!landing_) return false;
    try {
        for (std::size_t i = 0; i < to.targets().size(); ++i) landing_->targets()[i]->copy(*other.targets()[i]);
        for (std::size_t i = 0; i < to.targets().size(); ++i) to.targets()[i]->add(*landing_->targets()[i]);
    } catch (const Error& error) {
        if (error.code() != ErrorCode::DeviceFault) throw;
        return false;
    }
    return true;
}

void DeviceWorker::render(SharedRun& run, const SharedPicture& picture, uint32_t count, const Film& into,
                          const DeviceHooks& hooks) {
    held_ = {.device = number_, .film = nullptr, .slices = {}, .rays = {}};
    try {
        stay_near(queue_);
        const UseThreads use(queue_.threads());
        PictureRenderer& pictures = pictures_of(picture.pictures, picture.settings);
        if (hooks.before_samples) hooks.before_samples(number_);
        make_films(picture, into);
        DropSink drops(run);
        const bool has_steps = picture.settings.is_denoised();
        if (has_steps) {
            begin_steps(picture, pictures, drops);
        } else {
            steps_.reset();
        }
        Integrator& integrator =
            pictures.begin(picture.camera, picture.settings, has_steps ? 1 : count, picture.number);
        run.start_clock();
        integrator.stop_with(&drops);
        const auto goes_on = [&](double share) { return run.goes_on_making(number_, share); };
        if (integrator.prepare(goes_on)) take_slices(run, picture, pictures, integrator, drops, hooks);
        integrator.stop_with(nullptr);
    } catch (const Error& error) {
        if (is_its_own(error)) {
            run.lose(held_, error);
        } else {
            run.fail(std::current_exception());
        }
    } catch (...) {
        run.fail(std::current_exception());
    }
    run.leave();
}

/// Makes the steps of a denoised picture, which have its features from then on, and no samples.
void DeviceWorker::begin_steps(const SharedPicture& picture, PictureRenderer& pictures, Sink& drops) {
    if (!steps_ || steps_of_ != &pictures) {
        steps_.emplace(pictures);
        steps_of_ = &pictures, steps_number_ = 0;
    }
    if (steps_number_ == picture.number) return steps_->forget_samples();
    steps_number_ = 0;
    if (steps_->begin(picture.camera, picture.settings, queue_.is_cuda() ? nullptr : &drops))
        steps_number_ = picture.number;
}

/// Renders each sample alone, and adds it with its moments.
void DeviceWorker::add_moments(Integrator& integrator, const SharedPicture& picture, SampleRange slice) {
    Film& one = fit_film(*film_queue_, sample_film_, picture.settings, picture.add_targets);
    one.set_place_of(*held_.film);
    for (uint32_t sample = slice.first; sample < slice.end; ++sample) {
        clear(one);
        integrator.render(sample, 1, one.view());
        take_moments(queue_, one);
        for (std::size_t i = 0; i < one.targets().size(); ++i) held_.film->targets()[i]->add(*one.targets()[i]);
    }
    film_queue_->wait();
}

void DeviceWorker::add_samples(Integrator& integrator, const SharedPicture& picture, SampleRange slice, Sink& drops) {
    if ((picture.settings.sample_layers & kLayerVariance) != 0) {
        add_moments(integrator, picture, slice);
    } else if (!steps_) {
        integrator.render(slice.first, slice.count(), held_.film->view());
    } else {
        steps_->add(integrator, slice.first, slice.count(), *held_.film, queue_.is_cuda() ? nullptr : &drops);
    }
}

void DeviceWorker::take_slices(SharedRun& run, const SharedPicture& picture, PictureRenderer& pictures,
                               Integrator& integrator, Sink& drops, const DeviceHooks& hooks) {
    double rate = 0;                          // samples per second
    const RayCounts made = integrator.rays(); // by the precomputation, which counts once for all devices
    Stopwatch since_fold;
    const auto submit = [&] {
        Film& next = other_film();
        if (steps_) { // the samples take along what they gathered
            const DenoiserState state = steps_->state();
            denoiser_target(*held_.film)->set_bytes(std::as_bytes(std::span(state)));
            steps_->forget_samples();
        }
        run.submit(std::exchange(held_, {.device = number_, .film = &next, .slices = {}, .rays = {}}), &next);
        since_fold.restart();
    };
    for (;;) {
        const std::optional<SampleRange> slice = run.take(number_, rate);
        if (!slice) {
            if (run.is_dropped() || run.is_lost(number_)) break;
            if (!held_.slices.empty()) {
                submit();
            } else if (!run.wait_for_work(number_)) {
                break;
            }
            continue;
        }
        held_.slices.push_back(*slice); // at once, so that it is known if it is lost
        const Stopwatch watch;
        const bool is_first = slice->first == picture.first;
        const RayCounts before = integrator.rays();
        if (is_first) pictures.find_centres(picture.camera, picture.settings, *held_.film);
        add_samples(integrator, picture, *slice, drops);
        pictures.add_first_hits(picture.camera, picture.settings, *slice, *held_.film);
        if (hooks.after_slice) hooks.after_slice(number_, *slice);
        if (run.is_dropped()) break;
        const double now = slice->count() / std::max(watch.seconds(), 1e-9);
        rate = rate > 0 ? 0.5 * (rate + now) : now;
        held_.rays = held_.rays + (integrator.rays() - before) + (is_first ? made : RayCounts());
        held_.done += slice->count();
        run.add_done(slice->count());
        if (since_fold.seconds() >= hooks.fold_s) submit();
    }
    // A device whose film could not be read is lost with what it holds.
    if (run.is_lost(number_)) throw Error(ErrorCode::DeviceFault, "its film cannot be read");
}

} // namespace pertev
