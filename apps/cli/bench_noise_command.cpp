// pertev bench noise: the variance of a picture at a number of samples, of the low-discrepancy sampler beside that of
// independent samples. Pictures of several seeds are compared with each other, so no reference is needed.

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "apps/cli/bench_parts.h"
#include "apps/cli/flag_checks.h"
#include "apps/cli/interrupt.h"
#include "apps/cli/render_flags.h"
#include "base/limits.h"
#include "image/metrics.h"

namespace pertev {
namespace {

struct NoiseFlags {
    RenderFlags render;
    uint32_t seeds = 8;
    float keep_percent = 100;
};

struct NoiseFigures {
    double error = 0, seconds = 0, mean = 0; // relMSE, of one picture; channels' mean
    uint64_t invalid_samples = 0;
    double efficiency() const { return error > 0 && seconds > 0 ? 1 / (error * seconds) : 0; }
};

NoiseFigures measure(Queue& queue, const PreparedScene& prepared, const Camera& camera, RenderSettings settings,
                     SamplerKind sampler, const NoiseFlags& flags) {
    NoiseFigures figures;
    settings.path.sampler = sampler;
    std::vector<Image> pictures;
    for (uint32_t i = 0; i < flags.seeds; ++i) {
        throw_if_interrupted();
        settings.path.seed = flags.render.seed + i;
        RenderResult result =
            render_picture(queue, prepared, camera, settings, [](const RenderProgress&) { return !interrupted(); });
        throw_if_interrupted();
        figures.seconds += result.render_seconds / flags.seeds;
        figures.invalid_samples += result.invalid_samples;
        pictures.push_back(std::move(result.picture));
    }
    const TrimmedVariance variance =
        relative_variance(pictures, static_cast<double>(flags.keep_percent) / 100);
    figures.error = variance.rel_mse;
    figures.mean = variance.mean;
    return figures;
}

void print(const NoiseFlags& flags, const RenderSettings& settings, const Queue& queue, const NoiseFigures& sobol,
           const NoiseFigures& independent, Reporter& reporter) {
    const std::string& scene = flags.render.scene.scene;
    const double ratio = sobol.error > 0 ? independent.error / sobol.error : 0;
    if (reporter.json()) {
        reporter.event(fmt::format(
            R"({{"event":"noise","scene":{},"device":{},"width":{},"height":{},"samples":{},"seeds":{},"keep_percent":{:.4g},"rel_mse":{:.6e},"rel_mse_independent":{:.6e},"ratio":{:.4f},"seconds":{:.5f},"efficiency":{:.6g},"efficiency_independent":{:.6g},"mean":{:.6f},"mean_independent":{:.6f},"invalid_samples":{}}})",
            json_string(scene), json_string(queue.device_name()), settings.width, settings.height, settings.samples,
            flags.seeds, flags.keep_percent, sobol.error, independent.error, ratio, sobol.seconds, sobol.efficiency(),
            independent.efficiency(), sobol.mean, independent.mean, sobol.invalid_samples + independent.invalid_samples));
        return;
    }
    reporter.answer(fmt::format(
        "{} on {}: {}x{}, {} spp, {} seeds, {:.4g} % of the pixels\n"
        "relMSE {:.3e}, independent samples {:.3e}: {:.2f} times less; mean {:.5f} and {:.5f}\n"
        "{:.4f} s a picture, 1 / (relMSE x s) {:.4g}, independent samples {:.4g}\n",
        scene, queue.device_name(), settings.width, settings.height, settings.samples, flags.seeds, flags.keep_percent,
        sobol.error, independent.error, ratio, sobol.mean, independent.mean, sobol.seconds, sobol.efficiency(),
        independent.efficiency()));
}

int bench_noise(const NoiseFlags& flags) {
    Reporter reporter(flags.render.report);
    Messages& messages = reporter.messages();
    check_scene_options(flags.render.scene);
    listen_for_interrupt();
    const std::unique_ptr<Queue> queue = take_machine(flags.render.machine, messages);
    const Scene scene = load_scene(flags.render.scene, messages);
    const RenderSettings settings = render_settings(flags.render, scene);
    const float aspect = static_cast<float>(settings.width) / static_cast<float>(settings.height);
    const Camera camera = choose_camera(flags.render.scene, scene, aspect, messages);
    throw_if_interrupted();
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    reporter.say_messages();

    RenderSettings warm_up = settings; // clocks, caches, the driver's first launch
    warm_up.samples = 1;
    render_picture(*queue, prepared, camera, warm_up);
    const NoiseFigures sobol = measure(*queue, prepared, camera, settings, SamplerKind::Sobol, flags);
    const NoiseFigures independent = measure(*queue, prepared, camera, settings, SamplerKind::Independent, flags);
    print(flags, settings, *queue, sobol, independent, reporter);
    return 0;
}

} // namespace

void add_bench_noise_command(CLI::App& bench, int& status) {
    CLI::App& verb = *bench.add_subcommand("noise", "The variance of a picture, beside that of independent samples");
    const auto flags = std::make_shared<NoiseFlags>();
    flags->render.size = "640x360";
    add_scene_options(verb, flags->render.scene);
    add_light_path_flags(verb, flags->render, "Picture");
    verb.add_option("--size", flags->render.size, "of the pictures")->type_name("WIDTHxHEIGHT")->capture_default_str();
    verb.add_option("--seeds", flags->seeds, "pictures of each sampler")
        ->type_name("N")
        ->check(whole_between(2, 1024))
        ->capture_default_str();
    verb.add_option("--keep", flags->keep_percent, "of the pixels, those with the least variance")
        ->type_name("PERCENT")
        ->check(number_above_zero(100))
        ->capture_default_str();
    add_machine_flags(verb, flags->render.machine);
    add_report_flags(verb, flags->render.report);
    verb.callback([&verb, flags, &status] {
        refuse_flags_before(verb);
        status = bench_noise(*flags);
    });
}

} // namespace pertev
