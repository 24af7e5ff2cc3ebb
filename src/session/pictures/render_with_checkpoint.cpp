#include "session/pictures/render_with_checkpoint.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/stopwatch.h"
#include "session/pictures/render_samples.h"

namespace pertev {
namespace {

/// Returns the header of the finished film.
FilmHeader header_of(const PictureOptions& options, const PictureRecord& record, const Film& film) {
    FilmHeader header = film_header(options, record, facts_of(record, {}), {}, film);
    header.parts = {record.settings.part()};
    return header;
}

} // namespace

RenderWithCheckpoint::RenderWithCheckpoint(Session& session, const PictureOptions& options, const PictureRecord& record,
                                           Sink& sink)
    : record_(record), every_s_(options.checkpoint_every_s),
      is_part_(!options.part.empty() || !options.samples.empty()), settings_(session.settings()),
      film_(session.pictures(), session.camera(), settings_),
      checkpoint_(options.checkpoint, header_of(options, record, film_.film())), written_({options.checkpoint, ""}) {
    checkpoint_.restore(film_, sink);
    checkpoint_.check_space(film_.film());
    known_ = film_.samples().count();
    known_rays_ = film_.rays().total();
    if (known_ > 0) kept_ = known_;
}

/// Returns the progress of this render for that of a slice.
Progress RenderWithCheckpoint::progress_of_all(Progress now, double before_s, uint64_t rays_before) const {
    now.seconds += before_s;
    now.rays += rays_before;
    if (now.made_share < 1) return now;
    const double limit_s = settings_.time_limit_s, taken = now.samples_done - known_;
    now.share = static_cast<double>(now.samples_done) / now.samples;
    if (taken > 0) now.seconds_left = now.seconds * (now.samples - now.samples_done) / taken;
    if (limit_s > 0) {
        now.share = std::clamp(now.seconds / limit_s, now.share, 1.0);
        now.seconds_left = std::min(now.seconds_left.value_or(limit_s), std::max(limit_s - now.seconds, 0.0));
    }
    return now;
}

/// Renders until the checkpoint is due, or as FilmRender::render.
void RenderWithCheckpoint::render_slice(double before_s, Sink& sink) {
    const uint32_t before = film_.samples().count();
    const uint64_t rays_before = film_.rays().total() - known_rays_;
    RenderSettings settings = settings_;
    if (settings.time_limit_s > 0) settings.time_limit_s = std::max(settings.time_limit_s - before_s, 1e-9);
    film_.set_settings(settings);
    const Stopwatch watch;
    ProgressSink slice(
        [&](const Progress& now) {
            sink.progress(progress_of_all(now, before_s, rays_before));
            return now.samples_done == before || watch.seconds() < every_s_;
        },
        sink);
    film_.render({settings.first_sample + before, settings.samples}, slice);
}

/// Returns whether the checkpoint has all samples of the film.
bool RenderWithCheckpoint::write() {
    const uint32_t samples = film_.samples().count();
    if (kept_ == samples) return true;
    try {
        checkpoint_.write(film_, facts_of(record_, film_.film().ids()));
        kept_ = samples;
        written_.failure.clear();
    } catch (const Error& error) {
        written_.failure = error.what();
    }
    return kept_ == samples;
}

RenderResult RenderWithCheckpoint::render(Sink& sink) {
    const Stopwatch watch;
    const uint32_t all = settings_.range().count();
    for (uint32_t before = known_; before < all && !sink.should_stop(); before = film_.samples().count()) {
        const double seconds = watch.seconds();
        const bool is_over = settings_.time_limit_s > 0 && seconds >= settings_.time_limit_s;
        if (is_over && before > known_) break;
        if (before > known_ && !write()) sink.warn(written_.failure + "; the render continues without this checkpoint");
        render_slice(seconds, sink);
        if (film_.samples().count() == before) break;
    }
    if (all > 0 && film_.samples().count() == 0) refuse_without_samples(settings_, sink);
    if (write() && film_.samples().count() == all) {
        sink.note(
            fmt::format("{} keeps the samples{}", checkpoint_.file(), is_part_ ? "" : "; a larger `spp` adds to them"));
    }
    RenderResult result = film_.result();
    note_hidden_backs(result, sink);
    return result;
}

} // namespace pertev
