#include "lab/run_transport.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "base/stopwatch.h"
#include "image/auto_exposure.h"
#include "image/false_color.h"
#include "image/flip.h"
#include "image/metrics.h"
#include "image/tone_map_image.h"
#include "integrators/kinds/make_integrator.h"
#include "lab/transport_light.h"
#include "lab/transport_solutions.h"
#include "session/check_integrator.h"
#include "settings/value_names.h"

namespace pertev {
namespace {

struct TransportStopped {};

RenderSettings settings_of(const TransportSettings& settings, const std::string& integrator, uint32_t seed) {
    RenderSettings picture = settings.picture;
    if (!set_integrator(picture, integrator)) {
        throw Error(
            ErrorCode::BadInput, "integrator", integrator,
            fmt::format("there is no integrator with this name; there are {}", fmt::join(integrator_names(), ", ")));
    }
    picture.path.seed = seed;
    return picture;
}

/// Returns the host's memory that the integrator allocates besides the device's.
std::size_t host_bytes_of(const RenderSettings& picture) {
    Queue queue = Queue::make_dry_run(false);
    const std::unique_ptr<Integrator> integrator = make_integrator(queue, picture);
    integrator->reserve({.width = picture.width, .height = picture.height, .samples = 1});
    return integrator->host_bytes();
}

/// Draws errors in [0, 1] in false colours; an empty picture yields an empty one.
Rgba8Image draw_errors(const Image& errors) {
    Rgba8Image image = {errors.width, errors.height, std::vector<uint8_t>(4 * errors.pixels.size(), 255)};
    for (std::size_t i = 0; i < errors.pixels.size(); ++i) {
        set_pixel(image, static_cast<uint32_t>(i % errors.width), static_cast<uint32_t>(i / errors.width),
                  false_color(errors.pixels[i]));
    }
    return image;
}

class TransportRunner {
public:
    TransportRunner(Queue& queue, const Scene& scene, const Camera& camera, const TransportSettings& settings,
                    Sink& sink)
        : queue_(queue), scene_(scene), camera_(camera), settings_(settings), sink_(sink) {
        report_.camera = settings.camera;
        for (const std::string& name : settings.integrators) {
            settings_of(settings, name, 0);
            report_.rows.push_back({.name = name, .light = light_of(name, scene)});
            TransportRow& row = report_.rows.back();
            row.finds_all = row.light == kAllLight;
            row.is_solved = is_solved(settings_of(settings, name, 0).integrator);
            row.refused = why_not(name);
        }
        check_reference();
    }

    TransportScene run() {
        try {
            progress("building trees");
            prepared_ = prepare_scene(scene_, prepare_options(settings_.picture, queue_.is_cuda()), nobody());
            report_.triangles = prepared_.triangles;
            turns_left_ = static_cast<double>(settings_.repetitions) *
                          static_cast<double>(std::ranges::count(report_.rows, "", &TransportRow::refused));
            if (turns_left_ > 0) make_reference();
            for (uint32_t repetition = 0; repetition < settings_.repetitions; ++repetition) {
                for (TransportRow& row : report_.rows) {
                    if (row.refused.empty()) run_repetition(row, repetition);
                }
            }
        } catch (const TransportStopped&) {
            report_.interrupted = true;
        }
        add_notes();
        return std::move(report_);
    }

private:
    /// Returns why the integrator cannot render the scene; empty if it can.
    std::string why_not(const std::string& integrator) const {
        try {
            const RenderSettings picture = settings_of(settings_, integrator, 0);
            check_integrator(picture);
            check_camera(picture, camera_);
            check_light(picture, scene_, nobody());
            if (is_solved(picture.integrator)) return why_no_solution(scene_);
        } catch (const Error& error) {
            return error.setting() == "integrator" ? error.reason() : error.what();
        }
        return {};
    }

    void check_reference() {
        TransportReference& reference = report_.reference;
        if (!settings_.reference) {
            reference.integrator = settings_.reference_integrator;
            if (const std::string why = why_not(reference.integrator); !why.empty()) {
                throw Error(ErrorCode::BadInput, "reference", reference.integrator,
                            fmt::format("it cannot render the reference: {}", why));
            }
            reference.lacks = light_lacking(reference.integrator, scene_);
            return;
        }
        reference.file = settings_.reference_file;
        const Image& given = *settings_.reference;
        const RenderSettings& picture = settings_.picture;
        if (given.width != picture.width || given.height != picture.height) {
            throw Error(ErrorCode::BadInput, "reference", reference.file,
                        fmt::format("the reference has {0}x{1} pixels, the pictures {2}x{3}; set `size={0}x{1}`",
                                    given.width, given.height, picture.width, picture.height));
        }
        if (!std::ranges::all_of(given.pixels, [](float value) { return std::isfinite(value); })) {
            throw Error(ErrorCode::BadInput, "reference", reference.file,
                        "the reference has values that are not finite");
        }
    }

    double share_s() const { return settings_.seconds / settings_.repetitions; }

    void progress(const std::string& doing, double share_of_that = 0, double left_of_that_s = 0) {
        const double now_s = watch_.seconds();
        // A remaining turn is expected to take the mean time of the finished ones; the first takes its share.
        const double turn_s = turns_ > 0 ? turns_s_ / turns_ : share_s();
        const double left_s = left_of_that_s + turns_left_ * turn_s;
        share_ = std::max(share_, left_s > 0 ? now_s / (now_s + left_s) : share_);
        if (!sink_.goes_on({doing, share_, now_s, left_s, share_of_that})) throw TransportStopped{};
    }

    /// Returns the seconds that a turn has left; `made_s` of the elapsed seconds were spent before its first sample.
    double left_of_turn_s(const TransportRow& row, double seconds, uint32_t samples, double made_s = 0) const {
        if (!row.repetitions.empty()) return std::max(0.0, row.repetitions.front().back().seconds - seconds);
        const double to_most_s = (seconds - made_s) / std::max(1u, samples) * (settings_.max_samples - samples);
        return std::max(0.0, std::min(share_s() - seconds, samples > 0 ? to_most_s : share_s()));
    }

    /// Adds samples to the session's film. Returns the film's new figures, without errors; `before` has the old ones.
    TransportFigures render(Session& session, const TransportRow& row, uint32_t samples, const std::string& doing,
                            const TransportFigures& before) {
        TransportFigures all;
        session.render(samples - before.samples, ProgressSink([&](const Progress& now) {
                           all = {.samples = now.samples_done,
                                  .seconds = before.seconds + now.seconds,
                                  .made_seconds = before.made_seconds + now.made_seconds};
                           const double left_s = left_of_turn_s(row, all.seconds, all.samples, all.made_seconds);
                           progress(doing, all.seconds / (all.seconds + left_s), left_s);
                           return true;
                       }));
        return all;
    }

    /// Renders one of the reference's two halves.
    Image render_half(uint32_t half, uint32_t samples) {
        TransportReference& reference = report_.reference;
        const std::string doing = fmt::format("reference by {}", reference.integrator);
        progress(doing);
        Session session(queue_, prepared_, camera_,
                        settings_of(settings_, reference.integrator, reference_seed(settings_, half)));
        double seconds = 0;
        session.render(samples, ProgressSink([&](const Progress& now) {
                           seconds = now.seconds;
                           const double share = (static_cast<double>(now.samples_done) / samples + half) / 2;
                           const double all_s = reference.seconds + seconds;
                           progress(doing, share, share > 0 ? all_s / share - all_s : 0);
                           return true;
                       }));
        reference.seconds += seconds;
        return session.picture();
    }

    void make_reference() {
        if (settings_.reference) {
            reference_ = *settings_.reference;
        } else {
            const uint32_t samples = std::max(1u, settings_.reference_samples / 2);
            const Image halves[2] = {render_half(0, samples), render_half(1, samples)};
            VarianceOfPictures variance;
            for (const Image& half : halves) variance.add(half);
            std::vector<std::size_t> all(std::size_t(halves[0].width) * halves[0].height);
            std::iota(all.begin(), all.end(), std::size_t(0));
            report_.reference.samples = 2 * samples;
            report_.reference.rel_mse = variance.over(all).rel_mse / 2; // the mean of two halves has half the
                                                                        // variance
            report_.reference.flip = hdr_flip(halves[0], halves[1]).mean;
            reference_ = mean_of(halves[0], halves[1]);
        }
        exposure_stops_ = auto_exposure_stops(reference_, ToneMap::Agx);
        add_picture("reference", describe_reference(report_.reference), reference_);
    }

    void add_picture(const std::string& title, const std::string& caption, const Image& picture,
                     const Image& error = {}) {
        report_.pictures.push_back({.title = title,
                                    .caption = caption,
                                    .image = tone_map_image(picture, ToneMap::Agx, exposure_stops_, false),
                                    .error = draw_errors(error),
                                    .linear = picture});
    }

    /// Runs one repetition of one integrator.
    void run_repetition(TransportRow& row, uint32_t number) {
        const Stopwatch watch;
        const std::string doing = fmt::format("{}, {} of {}", row.name, number + 1, settings_.repetitions);
        turns_left_ -= 1;
        progress(doing, 0, left_of_turn_s(row, 0, 0));
        Repetition figures;
        std::vector<Image> pictures;
        bool stopped = false;
        try {
            if (row.is_solved) {
                stopped = !add_solutions(row, number, doing, figures, pictures);
            } else {
                stopped = !add_samples(row, number, doing, figures, pictures);
            }
        } catch (const Error& error) {
            if (error.code() != ErrorCode::OutOfMemory && error.code() != ErrorCode::OverLimit &&
                error.code() != ErrorCode::BadInput) {
                throw;
            }
            turns_left_ -= static_cast<double>(settings_.repetitions - 1 - number);
            row.refused = error.what();
            row.repetitions.clear();
            return;
        }
        if (number == 0 || !stopped) compare(row, number, std::move(figures), pictures);
        turns_ += 1, turns_s_ += watch.seconds();
        if (stopped) throw TransportStopped{};
    }

    /// Adds samples until the time is used up. Returns false if it was stopped.
    bool add_samples(TransportRow& row, uint32_t number, const std::string& doing, Repetition& figures,
                     std::vector<Image>& pictures) {
        bool stopped = false;
        const std::size_t before = queue_.allocated_bytes();
        Session session(queue_, prepared_, camera_,
                        settings_of(settings_, row.name, repetition_seed(settings_, number)));
        warm_up(session, [&] { progress(doing, 0, left_of_turn_s(row, 0, 0)); });
        try {
            add_figures(session, row, number, doing, figures, pictures);
        } catch (const TransportStopped&) {
            stopped = true;
        }
        row.bytes = std::max(row.bytes, queue_.allocated_bytes() - before);
        row.host_bytes = std::max(row.host_bytes, host_bytes_of(session.settings()));
        row.invalid_samples += session.stats().invalid_samples;
        return !stopped;
    }

    /// Renders solutions of growing detail, each about four times the patches of the one before, while the next one
    /// alone would fit into a repetition's share of the time. Later repetitions make as many as the first. Returns
    /// false if it was stopped.
    bool add_solutions(TransportRow& row, uint32_t number, const std::string& doing, Repetition& figures,
                       std::vector<Image>& pictures) {
        const Stopwatch watch;
        const RenderSettings picture = settings_of(settings_, row.name, repetition_seed(settings_, number));
        const uint32_t samples = std::min(kSolutionSamples, settings_.max_samples);
        ProgressSink report([&](const Progress& now) {
            progress(fmt::format("{}, solution {}: {}", doing, figures.size() + 1, now.doing), now.share,
                     left_of_turn_s(row, watch.seconds(), 0));
            return true;
        });
        try {
            for (bool is_next = true; is_next;) {
                const auto level = static_cast<uint32_t>(figures.size());
                SolvedPicture solved = solve_picture(queue_, prepared_, camera_, picture, level, samples, report);
                row.bytes = std::max(row.bytes, solved.device_bytes);
                row.host_bytes = std::max(row.host_bytes, solved.host_bytes);
                row.invalid_samples += solved.invalid_samples;
                figures.push_back(solved.figures);
                pictures.push_back(std::move(solved.picture));
                is_next = number > 0 ? figures.size() < row.repetitions.front().size()
                                     : level + 1 < settings_.max_solutions && 4 * solved.figures.seconds <= share_s() &&
                                           may_be_solved(prepared_, level + 1);
            }
        } catch (const TransportStopped&) {
            return false;
        }
        return true;
    }

    void add_figures(Session& session, const TransportRow& row, uint32_t number, const std::string& doing,
                     Repetition& figures, std::vector<Image>& pictures) {
        TransportFigures last;
        for (uint32_t samples = 1;;) {
            last = render(session, row, samples, doing, last);
            figures.push_back(last);
            pictures.push_back(session.picture());
            if (number > 0) {
                const Repetition& first = row.repetitions.front();
                if (figures.size() >= first.size()) return;
                samples = first[figures.size()].samples;
            } else {
                samples = next_samples(last, share_s(), settings_.max_samples);
                if (samples == 0) return;
            }
        }
    }

    /// Compares the repetition's pictures with the reference; a repetition without figures adds nothing.
    void compare(TransportRow& row, uint32_t number, Repetition figures, const std::vector<Image>& pictures) {
        if (figures.empty()) return;
        std::vector<const Image*> all;
        for (const Image& picture : pictures) all.push_back(&picture);
        const std::vector<FlipResult> flips = hdr_flips(all, reference_);
        for (std::size_t i = 0; i < figures.size(); ++i) {
            figures[i].rel_mse = relative_error(pictures[i], reference_, 1.0).rel_mse;
            figures[i].flip = flips[i].mean;
        }
        if (number == 0) {
            const TransportFigures& last = figures.back();
            add_picture(
                row.name,
                fmt::format("{}{} samples, {:.3g} s, relMSE {:.3g}; beside it the HDR-FLIP of each pixel, mean {:.3g}",
                            row.is_solved ? fmt::format("{} patches, ", last.patches) : "", last.samples, last.seconds,
                            last.rel_mse, last.flip),
                pictures.back(), flips.back().map);
        }
        row.repetitions.push_back(std::move(figures));
    }

    void add_notes() {
        const TransportReference& reference = report_.reference;
        if (!reference.lacks.empty()) report_.notes.push_back("the reference lacks " + reference.lacks);
        for (const TransportRow& row : report_.rows) {
            if (row.invalid_samples > 0) {
                report_.notes.push_back(
                    fmt::format("{}: {} samples were not finite and count as black", row.name, row.invalid_samples));
            }
            const std::vector<TransportPoint> points = points_of(row);
            if (row.is_solved && !points.empty()) {
                report_.notes.push_back(
                    fmt::format("{}: its light is scattered any number of times, that of the others at most {} times",
                                row.name, settings_.picture.path.max_depth));
            }
            if (points.empty() || !reference.rel_mse || !row.finds_all) continue;
            if (points.back().rel_mse.mean < 10 * *reference.rel_mse) {
                report_.notes.push_back(fmt::format(
                    "{}: the reference's own noise is {:.0f} % of its last relMSE; `reference_spp` makes it less",
                    row.name, 100 * *reference.rel_mse / points.back().rel_mse.mean));
            }
        }
    }

    Queue& queue_;
    const Scene& scene_;
    const Camera& camera_;
    const TransportSettings& settings_;
    Sink& sink_;
    TransportScene report_;
    PreparedScene prepared_;
    Image reference_;
    float exposure_stops_ = 0;
    Stopwatch watch_;
    double share_ = 0, turns_left_ = 0, turns_ = 0, turns_s_ = 0;
};

} // namespace

uint32_t next_samples(const TransportFigures& last, double share_s, uint32_t most) {
    const double sampled_s = last.seconds - last.made_seconds, for_samples_s = share_s - last.made_seconds;
    const double fitting = sampled_s > 0 ? for_samples_s / sampled_s * last.samples : most;
    const auto least = static_cast<double>(last.samples) * 9 / 8;
    const double next = std::min({fitting, 2.0 * last.samples, static_cast<double>(most)});
    return next >= std::max(least, last.samples + 1.0) ? static_cast<uint32_t>(next) : 0;
}

void warm_up(Session& session, const std::function<void()>& report) {
    bool has_begun = false;
    session.render(1, ProgressSink([&](const Progress& now) {
                       if (report) report();
                       return now.made_share >= 1 || !std::exchange(has_begun, true);
                   }));
    session.cut();
}

TransportScene run_transport(Queue& queue, const Scene& scene, const Camera& camera, const TransportSettings& settings,
                             Sink& sink) {
    return TransportRunner(queue, scene, camera, settings, sink).run();
}

} // namespace pertev
