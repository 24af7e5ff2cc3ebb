#include "session/film_render.h"

#include <algorithm>

#include "base/error.h"
#include "base/limits.h"
#include "base/stopwatch.h"
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
    const FilmPart part = settings.part();
    const uint64_t pixels = uint64_t(settings.window().width) * (part.end_row - part.first_row);
    const uint32_t at_once =
        settings.time_limit_s > 0 ? 1 : std::min(samples_at_once(settings, pixels), std::max(done, kFirstAtOnce));
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
    restart_for_scene();
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
    number_ = pictures_.new_number();
    forget_samples();
}

/// Resets the number of samples. The film itself is cleared at its next use.
void FilmRender::forget_samples() {
    stats_ = {};
    film_is_old_ = true;
}

void FilmRender::restart_for_scene() {
    hidden_back_share_.reset();
    restart();
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
    if (settings_.denoise == Denoise::None) return add_targets_;
    const DenoiserStateSize size = denoiser_state_size(settings_.denoise, settings_.width, settings_.height);
    return [add = add_targets_, size, steps = steps_, are_several = pictures_.sharing() != nullptr](Film& film) {
        if (add) add(film);
        if (are_several) return film.hold(std::make_unique<DenoiserTarget>(size)); // each device has its own steps
        film.hold(std::make_unique<DenoiserTarget>(size, [steps] { return steps->state(); }));
    };
}

/// Returns `film`, made if it does not fit the settings, for their rows.
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
        if (settings_.denoise != Denoise::None && pictures_.sharing() == nullptr) {
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
    const uint32_t first = range.first, before = samples().count();
    const uint32_t count = std::min(range.count(), kMaxSamplesPerPixel - std::min(first, kMaxSamplesPerPixel));
    if (count == 0) return 0;
    if (SharedRender* const sharing = pictures_.sharing()) {
        find_hidden_backs(); // while its device is known to work
        Film& into = film();
        SharedSamples added;
        try {
            const AddTargets add = targets_of_films();
            const SharedPicture picture = {pictures_, camera_, settings_, add, number_, first - before};
            added = sharing->render(picture, {first, first + count}, before, into, sink);
        } catch (...) {
            forget_samples();
            throw;
        }
        if (added.count == 0) return 0;
        into.set_samples({first - before, first + added.count});
        stats_.rays = stats_.rays + added.rays;
        stats_.render_seconds += added.seconds;
        if (before == 0) stats_.first_pixel_seconds = added.first_seconds;
        return added.count;
    }
    const Stopwatch since_call;
    Film& into_film = film();
    const bool has_steps = settings_.denoise != Denoise::None;
    const bool on_cpu = !pictures_.queue().is_cuda(); // a GPU's passes are short
    if (has_steps && before == 0 && !steps_->begin(camera_, settings_, on_cpu ? &sink : nullptr)) return 0;
    Integrator& integrator = pictures_.begin(camera_, settings_, has_steps ? 1 : count, number_);
    if (before == 0) pictures_.find_centres(camera_, settings_, into_film);
    const RayCounts rays_before = stats_.rays;
    const double seconds_before = stats_.render_seconds;
    const Stopwatch watch;
    const bool has_moments = (settings_.sample_layers & kLayerVariance) != 0; // samples are rendered alone
    const bool is_apart = has_moments || (interrupts_passes_ && on_cpu && before > 0 && !has_steps);
    if (!is_apart) pass_film_.reset();
    Film& into = is_apart ? fit_part(pass_film_) : into_film;
    bool makes = false;
    const auto goes_on = [&](double made_share) {
        makes = true;
        const double seconds = watch.seconds();
        if (settings_.time_limit_s > 0 && seconds >= settings_.time_limit_s) return false;
        return sink.goes_on(made_progress(before, before + count, made_share, seconds, integrator.rays()));
    };
    if (!integrator.prepare(goes_on)) return 0;
    const double made_seconds = makes ? watch.seconds() : 0;
    for (uint32_t done = 0; done < count;) {
        const auto now = [&] {
            return progress_of(settings_, before + done, before + count, watch.seconds(), made_seconds,
                               integrator.rays());
        };
        const uint32_t pass = has_moments ? 1 : next_pass(settings_, count - done, done, watch.seconds());
        Sink* const stops = on_cpu && (interrupts_passes_ || (before == 0 && done == 0)) ? &sink : nullptr;
        integrator.stop_with(stops);
        uint32_t added = pass;
        try {
            if (has_steps) {
                steps_->add(integrator, first + done, pass, into_film, stops);
            } else {
                if (is_apart) into.clear();
                added = integrator.render_while(first + done, pass, into.view(), [&] { return sink.goes_on(now()); });
            }
        } catch (...) { // parts of the pass may be in the film
            if (!is_apart) forget_samples();
            throw;
        }
        if (stops != nullptr && added == pass && sink.should_stop()) { // parts of a sample may be missing
            if (is_apart) break;
            forget_samples();
            return 0;
        }
        if (added == 0) break;
        try {
            if (is_apart) {
                into.set_samples({first + done, first + done + added});
                if (has_moments) take_moments(pictures_.queue(), into);
                into_film.add(into);
            }
            pictures_.add_first_hits(camera_, settings_, {first + done, first + done + added}, into_film);
        } catch (...) { // the film may have light of samples that it does not count
            forget_samples();
            throw;
        }
        done += added;
        const double seconds = watch.seconds();
        into_film.set_samples({first - before, first + done});
        stats_.rays = rays_before + integrator.rays();
        stats_.kind_seconds = pictures_.scene().tracer().seconds();
        stats_.render_seconds = seconds_before + seconds;
        if (before == 0 && done == added) stats_.first_pixel_seconds = since_call.seconds();
        if (added < pass || !sink.goes_on(now())) break;
        if (settings_.time_limit_s > 0 && seconds >= settings_.time_limit_s) break;
    }
    return samples().count() - before;
}

void FilmRender::find_hidden_backs() {
    if (hidden_back_share_) return;
    const PictureView picture = pictures_.view_of(camera_, settings_); // first: it checks that there is a scene
    hidden_back_share_ = hidden_back_share(pictures_.queue(), pictures_.scene().tracer(), picture);
}

std::optional<Image> FilmRender::denoised() {
    if (settings_.denoise == Denoise::None || samples().count() == 0) return std::nullopt;
    if (pictures_.sharing() == nullptr) {
        Image image = steps_->apply(picture());
        denoiser_ = steps_->names();
        return image;
    }
    const DenoiserTarget* const gathered = denoiser_target(film());
    PERTEV_CHECK(gathered != nullptr);
    DenoiserState state(gathered->byte_count() / sizeof(uint32_t));
    gathered->read(0, std::as_writable_bytes(std::span(state)));
    const auto denoise_on = [&](Queue& queue) {
        DenoisedPicture denoised = denoise(queue, settings_, picture(), state);
        denoiser_ = std::move(denoised.denoiser);
        return std::move(denoised.image);
    };
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

} // namespace pertev
