// pertev bench noise: compares the variance of pictures by the low-discrepancy sampler and by independent samples.
// Pictures of several seeds are compared with each other, so no reference is needed.

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "apps/cli/bench_parts.h"
#include "apps/cli/flag_checks.h"
#include "apps/cli/interrupt.h"
#include "apps/cli/render_flags.h"
#include "image/metrics.h"
#include "session/session.h"
#include "settings/parse_values.h"

namespace pertev {
namespace {

struct NoiseFlags {
    RenderFlags render;
    uint32_t seeds = 8;
    float keep_percent = 100;
};

/// The pictures of one sampler.
struct Pictures {
    VarianceOfPictures variance;
    double seconds = 0; // time of one
    uint64_t invalid_samples = 0;
};

/// Renders the pictures of a sampler after `done` pictures of other samplers, which the progress counts.
Pictures render_pictures(Session& session, SamplerKind sampler, const NoiseFlags& flags, uint32_t done,
                         Reporter& reporter) {
    Pictures pictures;
    RenderSettings settings = session.settings();
    settings.path.sampler = sampler;
    const uint32_t of = 2 * flags.seeds;
    for (uint32_t i = 0; i < flags.seeds; ++i) {
        const auto report = [&](double share) {
            reporter.progress((done + i + share) / of, fmt::format("picture {} of {}", done + i + 1, of));
        };
        throw_if_interrupted();
        report(0);
        settings.path.seed = flags.render.render.path.seed + i;
        session.set_settings(settings);
        session.cut();
        session.render(settings.samples, ProgressSink([&](const Progress& now) {
                           report(now.share);
                           return !interrupted();
                       }));
        throw_if_interrupted();
        const RenderStats stats = session.stats();
        pictures.seconds += stats.render_seconds / flags.seeds;
        pictures.invalid_samples += stats.invalid_samples;
        pictures.variance.add(session.picture());
    }
    return pictures;
}

/// Figures of both samplers are taken over the pixels that the low-discrepancy sampler is best at, because those of
/// different pixels cannot be compared. The choice is made on its own pictures, so a small part of few seeds flatters
/// it.
Fields fields_of(const NoiseFlags& flags, const RenderSettings& settings, const Queue& queue, const Pictures& sobol,
                 const Pictures& independent) {
    const auto pixels = sobol.variance.best_pixels(static_cast<double>(flags.keep_percent) / 100);
    const TrimmedVariance low = sobol.variance.over(pixels), other = independent.variance.over(pixels);
    const auto efficiency = [](const TrimmedVariance& variance, double seconds) {
        return variance.rel_mse > 0 && seconds > 0 ? 1 / (variance.rel_mse * seconds) : 0;
    };
    return {{"scene", "scene", flags.render.scene.scene},
            {"device", "device", queue.device_name()},
            {"width", "width", settings.width},
            {"height", "height", settings.height},
            {"samples", "samples per pixel", settings.samples},
            {"seeds", "seeds", flags.seeds},
            {"keep_percent", "of the pixels", static_cast<double>(flags.keep_percent), "%"},
            {"pixels", "pixels", pixels.size()},
            {"rel_mse", "relMSE", low.rel_mse, "", "{:.3e}"},
            {"rel_mse_independent", "relMSE of independent samples", other.rel_mse, "", "{:.3e}"},
            {"ratio", "times less", low.rel_mse > 0 ? other.rel_mse / low.rel_mse : 0, "", "{:.2f}"},
            {"seconds", "a picture", sobol.seconds, "s", "{:.4f}"},
            {"seconds_independent", "a picture of independent samples", independent.seconds, "s", "{:.4f}"},
            {"efficiency", "1 / (relMSE x s)", efficiency(low, sobol.seconds)},
            {"efficiency_independent", "of independent samples", efficiency(other, independent.seconds)},
            {"mean", "mean", low.mean, "", "{:.5f}"},
            {"mean_independent", "mean of independent samples", other.mean, "", "{:.5f}"},
            {"invalid_samples", "invalid samples", sobol.invalid_samples + independent.invalid_samples}};
}

int bench_noise(NoiseFlags& flags) {
    Reporter reporter(flags.render.report);
    const std::unique_ptr<BenchedScene> benched = read_benched_scene(flags.render, kBenchNoise, reporter);
    const auto& [queue, scene, settings, camera, prepared, queues] = *benched;

    BenchReport report(reporter, flags.render.report, *queue, "Variance of a picture");
    throw_if_interrupted();
    reporter.set_work("warming up"); // clocks, caches, the driver's first launch
    Session session(*queue, prepared, camera, settings);
    session.render(1);
    const Pictures sobol = render_pictures(session, SamplerKind::Sobol, flags, 0, reporter);
    const Pictures independent = render_pictures(session, SamplerKind::Independent, flags, flags.seeds, reporter);
    reporter.end_progress();
    report.add_alone("noise", fields_of(flags, settings, *queue, sobol, independent));
    report.write();
    return 0;
}

} // namespace

void add_bench_noise_command(CLI::App& bench, int& status) {
    const auto flags = std::make_shared<NoiseFlags>();
    CLI::App& verb = add_bench_verb(bench, "noise", "Measure a picture's variance relative to independent samples",
                                    [flags, &status] { status = bench_noise(*flags); });
    flags->render.size = PictureSize{640, 360};
    add_scene_name(verb, flags->render.scene);
    add_whole(verb, "--seeds", flags->seeds, "number of pictures of each sampler", 2, 1024)->capture_default_str();
    verb.add_option("--keep", flags->keep_percent,
                    "share of pixels that are compared: those with the least variance\nof the low-discrepancy "
                    "sampler; a small share of few seeds\nis biased in its favour")
        ->type_name("PERCENT")
        ->check(number_above_zero(100))
        ->capture_default_str();
    add_bench_report_flags(verb, flags->render.report);
    flags->render.settings.add(verb, kBenchNoise, flags->render);
}

} // namespace pertev
