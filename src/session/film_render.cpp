#include "session/film_render.h"

#include <algorithm>

#include "base/error.h"
#include "base/limits.h"
#include "base/stopwatch.h"
#include "denoise/picture_history.h"
#include "render/hidden_back_share.h"
#include "render/sample_layers/variance_target.h"
#include "session/check_integrator.h"
#include "session/render_progress.h"
#include "session/shared_render.h"

namespace pertev {
namespace {

constexpr uint32_t kFirstAtOnce = 16; // samples of a first pass

/// Returns the number of samples of the next pass. It aims at a third of a second, so that progress updates and
/// Ctrl-C are timely at no noticeable cost. If samples are cheaper together and there is no time limit, a pass has as
/// many samples as are done already, up to the number that the integrator prefers: progress shows early, and the cost
/// of a pass is paid a few times only. It never exceeds the remaining time. `done` samples took `seconds`, and `left`
/// remain.
uint32_t next_pass(const RenderSettings& settings, uint32_t left, uint32_t done, double seconds) {
    if (settings.pass_samples > 0) return std::min(left, settings.pass_samples);
    const uint32_t preferred = samples_at_once(settings, settings.rendered_pixels());
    const uint32_t at_once = settings.time_limit_s > 0 ? 1 : std::min(preferred, std::max(done, kFirstAtOnce));
    if (done == 0) return std::min(left, at_once);
    const double a_sample = std::max(seconds / done, 1e-9);
    double budget = 1.0 / 3;
    if (settings.time_limit_s > 0) budget = std::min(budget, settings.time_limit_s - seconds);
    return std::min(left, std::max(at_once, static_cast<uint32_t>(std::clamp(budget / a_sample, 1.0, 65536.0))));
}

} // namespace

FilmRender::FilmRender(PictureRenderer& pictures, const Camera& camera, const RenderSettings& settings)
    : pictures_(pictures), camera_(camera), settings_(settings), steps_(std::make_shared<PostSteps>(pictures)),
      number_(pictures.new_number()) {
    check_integrator(settings);
    check_camera(settings, camera);
}

bool FilmRender::set_camera(const Camera& camera) {
    if (camera == camera_) return false;
    camera_ = camera;
    hidden_back_share_.reset();
    begin_picture();
    return true;
}

bool FilmRender::set_settings(const RenderSettings& settings) {
    const bool same = same_picture(settings_, settings);
    if (settings.denoise != settings_.denoise) film_.reset(); // it has another target
    if (settings.width != settings_.width || settings.height != settings_.height) hidden_back_share_.reset();
    settings_ = settings;
    if (film_ && !is_film_of(*film_, settings_)) film_.reset();
    if (!same) restart();
    return !same;
}

void FilmRender::restart() {
    if (PictureHistory* const history = steps_->history()) history->cut();
    scene_has_moved_ = false;
    begin_picture();
}

void FilmRender::begin_picture() {
    number_ = pictures_.new_number();
    forget_samples();
}

/// Resets the number of samples. The film itself is cleared at its next use.
void FilmRender::forget_samples() {
    stats_ = {};
    film_is_old_ = true;
}

void FilmRender::restart_for_scene() {
    if (has_history() && !scene_has_moved_) {
        pictures_.scene().keep_instances();
        scene_has_moved_ = true;
    }
    hidden_back_share_.reset();
    begin_picture();
}

/// Returns where the scene was in the picture that left a history.
PreviousScene FilmRender::scene_before() {
    const DeviceScene& scene = pictures_.scene();
    return scene_has_moved_ ? scene.before() : PreviousScene{scene.view().instances, scene.view().meshes};
}

FrameHistory FilmRender::history() const {
    FrameHistory history;
    history.camera = camera_;
    history.arrays = steps_->history()->save();
    return history;
}

void FilmRender::restore(const FrameHistory& history) {
    restart();
    steps_->restore_history(history.camera, settings_, history.arrays);
}

void FilmRender::set_targets(AddTargets add) {
    add_targets_ = std::move(add);
    film_.reset(), pass_film_.reset();
    restart();
}

Film& FilmRender::film() {
    if (film_ && film_is_old_) film_->clear();
    film_is_old_ = false;
    return fit_part(film_);
}

/// Returns what adds the targets of new films: those that set_targets() requests, and what a post step gathers.
AddTargets FilmRender::targets_of_films() {
    if (!settings_.is_denoised()) return add_targets_;
    const DenoiserStateSize size = denoiser_state_size(settings_.denoise, settings_.width, settings_.height);
    return [add = add_targets_, size, steps = steps_, are_several = pictures_.sharing() != nullptr](Film& film) {
        if (add) add(film);
        if (are_several) return film.hold(std::make_unique<DenoiserTarget>(size)); // each device has its own steps
        film.hold(std::make_unique<DenoiserTarget>(size, [steps] { return steps->state(); }));
    };
}

/// Returns `film` for the rows of the settings. Replaces it by a new one if it does not fit them.
Film& FilmRender::fit_part(std::optional<Film>& film) {
    Film& fit = fit_film(pictures_.film_queue(), film, settings_, targets_of_films());
    fit.set_rows(settings_.part().first_row, settings_.part().end_row);
    return fit;
}

void FilmRender::restore(SampleRange samples, const std::function<void(Film&)>& add, const RayCounts& rays,
                         double seconds) {
    restart();
    Film& into = film();
    try {
        add(into);
        if (settings_.is_denoised() && pictures_.sharing() == nullptr) {
            DenoiserTarget* const target = denoiser_target(into);
            PERTEV_CHECK(target != nullptr);
            steps_->begin(camera_, settings_, nullptr);
            steps_->restore(target->take());
        }
    } catch (...) {
        forget_samples();
        throw;
    }
    into.set_samples(samples);
    stats_.rays = rays, stats_.render_seconds = seconds;
}

uint32_t FilmRender::render(SampleRange range, Sink& sink) {
    PERTEV_CHECK(samples().count() == 0 || range.first == samples().end);
    const uint32_t first = range.first;
    const uint32_t count = std::min(range.count(), kMaxSamplesPerPixel - std::min(first, kMaxSamplesPerPixel));
    if (count == 0) return 0;
    const SampleRange possible = {first, first + count};
    return pictures_.sharing() != nullptr ? render_shared(possible, sink) : render_passes(possible, sink);
}

/// Adds `range` by several devices (PictureRenderer::sharing). Returns the number of samples added.
uint32_t FilmRender::render_shared(SampleRange range, Sink& sink) {
    const uint32_t before = samples().count(), films_first = range.first - before;
    find_hidden_backs(); // while its device is known to work
    Film& into = film();
    SharedSamples added;
    try {
        const AddTargets add = targets_of_films();
        RenderSettings of_devices = settings_;
        of_devices.history = 0; // that is the caller's, who denoises
        const SharedPicture picture = {pictures_, camera_, of_devices, add, number_, films_first};
        added = pictures_.sharing()->render(picture, range, before, into, sink);
    } catch (...) {
        forget_samples();
        throw;
    }
    if (added.count == 0) return 0;
    into.set_samples({films_first, range.first + added.count});
    stats_.rays = stats_.rays + added.rays;
    stats_.render_seconds += added.seconds;
    if (before == 0) stats_.first_pixel_seconds = added.first_seconds;
    return added.count;
}

/// The passes of one call of render().
struct FilmRender::Passes {
    bool are_apart() const { return &pass_film != &film; }
    SampleRange next(uint32_t count) const { return {range.first + done, range.first + done + count}; }
    bool is_time_over() const { return time_limit_s > 0 && watch.seconds() >= time_limit_s; }

    SampleRange range; // that was requested
    uint32_t before;   // samples that the film had before the call
    uint32_t done = 0; // samples of `range` that it has by now
    Film& film;        // receives the passes
    Film& pass_film;   // receives a pass first: `film`, or another one if `film` must survive an unfinished pass
    Integrator& integrator;
    Sink& sink;
    double time_limit_s; // 0: none
    RayCounts rays_before;
    double seconds_before;
    Stopwatch since_call, watch; // `watch` starts once the picture has begun
    double made_seconds = 0;     // when the integrator was prepared
};

/// Adds `range` pass by pass on this picture's device. Returns the number of samples added.
uint32_t FilmRender::render_passes(SampleRange range, Sink& sink) {
    const Stopwatch since_call;
    const uint32_t before = samples().count(), count = range.count();
    Film& whole = film();
    if (has_steps() && before == 0) {
        const auto features = range.first == 0 ? PostSteps::Features::WithSamples : PostSteps::Features::AtOnce;
        if (!steps_->begin(camera_, settings_, on_cpu() ? &sink : nullptr, scene_before(), features)) return 0;
    }
    Integrator& integrator = pictures_.begin(camera_, settings_, has_steps() ? 1 : count, number_);
    if (before == 0) pictures_.find_centres(camera_, settings_, whole);
    const Stopwatch watch;
    const bool are_apart = has_moments() || (interrupts_passes_ && on_cpu() && before > 0 && !has_steps());
    if (!are_apart) pass_film_.reset();
    Passes passes = {.range = range,
                     .before = before,
                     .film = whole,
                     .pass_film = are_apart ? fit_part(pass_film_) : whole,
                     .integrator = integrator,
                     .sink = sink,
                     .time_limit_s = settings_.time_limit_s,
                     .rays_before = stats_.rays,
                     .seconds_before = stats_.render_seconds,
                     .since_call = since_call,
                     .watch = watch};
    if (!prepare(passes)) return 0;
    while (passes.done < count) {
        const uint32_t wanted =
            has_moments() ? 1 : next_pass(settings_, count - passes.done, passes.done, passes.watch.seconds());
        const uint32_t added = render_pass(passes, wanted);
        if (added == 0) break;
        commit_pass(passes, added);
        if (added < wanted || !sink.goes_on(progress_of(passes)) || passes.is_time_over()) break;
    }
    const uint32_t after = samples().count();
    if (has_steps() && after > 0) steps_->add_features(nullptr); // some samples may not be rendered yet
    return after < before ? 0 : after - before;                  // an unfinished pass may have lost all samples
}

/// Lets the integrator compute what it needs before its first sample. Returns whether it did so to the end.
bool FilmRender::prepare(Passes& passes) {
    bool makes = false;
    const auto goes_on = [&](double made_share) {
        makes = true;
        if (passes.is_time_over()) return false;
        const uint32_t before = passes.before, end = before + passes.range.count();
        return passes.sink.goes_on(
            made_progress(before, end, made_share, passes.watch.seconds(), passes.integrator.rays()));
    };
    if (!passes.integrator.prepare(goes_on)) return false;
    if (makes) passes.made_seconds = passes.watch.seconds();
    return true;
}

Progress FilmRender::progress_of(const Passes& passes) const {
    return pertev::progress_of(settings_, passes.before + passes.done, passes.before + passes.range.count(),
                               passes.watch.seconds(), passes.made_seconds, passes.integrator.rays());
}

/// Renders the next `count` samples. Returns how many of them are complete: fewer if the integrator ended the pass,
/// none if the sink stopped a pass that may be left. The film's samples are then lost, unless passes are apart.
uint32_t FilmRender::render_pass(Passes& passes, uint32_t count) {
    const bool may_leave = on_cpu() && (interrupts_passes_ || (passes.before == 0 && passes.done == 0));
    Sink* const stops = may_leave ? &passes.sink : nullptr;
    passes.integrator.stop_with(stops);
    const uint32_t first = passes.next(count).first;
    uint32_t added = count;
    try {
        if (has_steps()) {
            steps_->add(passes.integrator, first, count, passes.film, stops);
        } else {
            if (passes.are_apart()) passes.pass_film.clear();
            added = passes.integrator.render_while(first, count, passes.pass_film.view(),
                                                   [&] { return passes.sink.goes_on(progress_of(passes)); });
        }
    } catch (...) { // parts of the pass may be in the film
        if (!passes.are_apart()) forget_samples();
        throw;
    }
    if (stops == nullptr || added < count || !stops->should_stop()) return added;
    if (!passes.are_apart()) forget_samples(); // parts of a sample may be missing
    return 0;
}

/// Counts the next `count` samples, which render_pass() has rendered, in the film and the statistics.
void FilmRender::commit_pass(Passes& passes, uint32_t count) {
    const SampleRange added = passes.next(count);
    try {
        if (passes.are_apart()) {
            passes.pass_film.set_samples(added);
            if (has_moments()) take_moments(pictures_.queue(), passes.pass_film);
            passes.film.add(passes.pass_film);
        }
        pictures_.add_first_hits(camera_, settings_, added, passes.film);
    } catch (...) { // the film may have light of samples that it does not count
        forget_samples();
        throw;
    }
    const bool is_first = passes.before == 0 && passes.done == 0;
    passes.done += count;
    passes.film.set_samples({passes.range.first - passes.before, added.end});
    stats_.rays = passes.rays_before + passes.integrator.rays();
    stats_.kind_seconds = pictures_.scene().tracer().seconds();
    stats_.render_seconds = passes.seconds_before + passes.watch.seconds();
    if (is_first) stats_.first_pixel_seconds = passes.since_call.seconds();
}

void FilmRender::find_hidden_backs() {
    if (hidden_back_share_) return;
    const PictureView picture = pictures_.view_of(camera_, settings_); // first: it checks that there is a scene
    hidden_back_share_ = hidden_back_share(pictures_.queue(), pictures_.scene().tracer(), picture);
}

std::optional<Image> FilmRender::denoised() {
    if (!settings_.is_denoised() || samples().count() == 0) return std::nullopt;
    if (pictures_.sharing() == nullptr) {
        Image image = steps_->apply(picture());
        denoiser_ = steps_->names();
        scene_has_moved_ = false; // the history is that of this picture
        return image;
    }
    DenoisedPicture denoised = denoise_shared();
    denoiser_ = std::move(denoised.denoiser);
    return std::move(denoised.image);
}

/// Denoises what several devices have gathered.
DenoisedPicture FilmRender::denoise_shared() {
    const DenoiserTarget* const gathered = denoiser_target(film());
    PERTEV_CHECK(gathered != nullptr);
    DenoiserState state(gathered->byte_count() / sizeof(uint32_t));
    gathered->read(0, std::as_writable_bytes(std::span(state)));
    if (settings_.has_history()) { // it ends with the first device: a fault there ends the frames
        if (begun_number_ != number_) steps_->begin_restored(camera_, settings_, scene_before());
        begun_number_ = number_;
        steps_->restore(state);
        scene_has_moved_ = false;
        return {steps_->apply(picture()), steps_->names()};
    }
    const auto denoise_on = [&](Queue& queue) { return denoise(queue, settings_, picture(), state); };
    try {
        return denoise_on(pictures_.queue());
    } catch (const Error& error) {
        if (error.code() != ErrorCode::DeviceFault) throw;
        return denoise_on(pictures_.film_queue()); // the film outlives a device that has failed
    }
}

RenderStats FilmRender::stats() {
    find_hidden_backs();
    RenderStats stats = stats_;
    stats.samples = samples().count();
    stats.invalid_samples = film().invalid_samples();
    stats.hidden_back_share = *hidden_back_share_;
    stats.upload_seconds = pictures_.scene().upload_seconds();
    stats.device_peak_bytes = pictures_.queue().peak_bytes();
    return stats;
}

RenderResult render_with_steps(PictureRenderer& pictures, const Camera& camera, const RenderSettings& settings,
                               uint32_t first) {
    if (!settings.is_denoised()) return pictures.render_separately(camera, settings, first);
    FilmRender film(pictures, camera, settings);
    film.render({first, first + settings.samples});
    return film.result();
}

} // namespace pertev
