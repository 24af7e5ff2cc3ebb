// pertev measure SCENE --at X,Y,Z --normal X,Y,Z: the light that arrives at a point, in numbers.

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "accel/builders/bvh_cache.h"
#include "apps/cli/commands.h"
#include "apps/cli/flag_checks.h"
#include "apps/cli/interrupt.h"
#include "apps/cli/reporter.h"
#include "apps/cli/scene_options.h"
#include "apps/cli/setting_flags.h"
#include "base/error.h"
#include "base/stopwatch.h"
#include "session/devices/machine.h"
#include "session/measure_irradiance.h"
#include "session/moving_scene.h"
#include "session/opening/strictness.h"
#include "session/pictures/choose_display.h"
#include "settings/parse_values.h"

namespace pertev {
namespace {

struct MeasureFlags : PictureOptions {
    std::string at, normal;
    SettingFlags settings;
    ReportFlags report;
};

MeterPoint point_of(const MeasureFlags& flags) {
    const MeterPoint point = {parse_position("at", flags.at), parse_vec3("normal", flags.normal)};
    check_meter(point, flags.render.path.seed);
    return point;
}

/// Returns a valid vector of the command line as JSON.
std::string json_of(const std::string& vector) { return json_vector(vector).value_or(json_string(vector)); }

std::string in_json(const Measured& m, double scale = 1) {
    return fmt::format(R"({{"value":{},"standard_error":{}}})", json_number(scale * m.value),
                       json_number(scale * m.standard_error));
}

/// Returns the value and its standard error with their significant digits.
std::string in_words(const Measured& m, double scale = 1) {
    return fmt::format("{:.6g} ± {:.2g}", scale * m.value, scale * m.standard_error);
}

void print(const MeasureFlags& flags, const Irradiance& e, const Queue& queue, double seconds, Reporter& reporter) {
    const double efficacy = efficacy_of(flags.scene);
    if (reporter.json()) {
        reporter.result(fmt::format(
            R"({{"event":"measure","scene":{},"at":{},"normal":{},"device":{},"irradiance_rgb":[{},{},{}],"irradiance":{},"illuminance":{},"lumens_per_watt":{},"paths":{},"invalid_paths":{},"rays":{},"max_depth":{},"seed":{},"seconds":{:.3f}}})",
            json_string(flags.scene.scene), json_of(flags.at), json_of(flags.normal), json_string(queue.device_name()),
            in_json(e.rgb[0]), in_json(e.rgb[1]), in_json(e.rgb[2]), in_json(e.luminance),
            in_json(e.luminance, efficacy), json_number(efficacy), e.paths, e.invalid_paths, e.rays.total(),
            flags.render.path.max_depth, flags.render.path.seed, seconds));
        return;
    }
    reporter.answer(fmt::format("irradiance   {} W/m2 (red {}, green {}, blue {})\n"
                                "illuminance  {} lx ({:.6g} lm/W)\n",
                                in_words(e.luminance), in_words(e.rgb[0]), in_words(e.rgb[1]), in_words(e.rgb[2]),
                                in_words(e.luminance, efficacy), efficacy));
    reporter.print(fmt::format("{} paths of at most {} scatterings on {} in {:.2f} s{}", e.paths,
                               flags.render.path.max_depth, queue.device_name(), seconds,
                               e.invalid_paths > 0 ? fmt::format("; {} were not finite", e.invalid_paths) : ""));
}

int measure(MeasureFlags& flags) {
    Reporter reporter(flags.report);
    flags.settings.read(flags, reporter);
    const MeterPoint point = point_of(flags); // before anything is read
    StartingMachine machine(flags.machine, reporter);
    const UseThreads threads(machine.threads());
    reporter.report_messages();
    reporter.set_work(fmt::format("loading {}", flags.scene.scene));
    const RenderSettings& settings = flags.render;
    Scene scene = open_scene(flags.scene, reporter, SceneUse::Measurement);
    if (flags.strict) refuse_what_is_left_out(reporter, "nothing was measured");
    for (Material& material : scene.materials) material.double_sided = true; // backs are hidden from cameras alone
    PrepareOptions prepare = prepare_options(settings, machine.may_be_cuda());
    prepare.may_be_better = true;
    if (!flags.no_cache) prepare.bvh_cache = bvh_cache_folder();
    reporter.set_work("building trees");
    const MovingScene moving(std::move(scene), flags.time_s, prepare, reporter);
    const std::unique_ptr<Queue> queue = machine.take();
    reporter.report_messages();
    listen_for_interrupt();
    reporter.set_work("measuring");
    const Stopwatch watch;
    ProgressSink part(
        [&](const Progress& now) {
            reporter.progress(now.share, "measuring");
            return true;
        },
        reporter);
    const Irradiance irradiance = measure_irradiance(*queue, moving.prepared(), point, settings, part);
    reporter.end_progress();
    print(flags, irradiance, *queue, watch.seconds(), reporter);
    return 0;
}

} // namespace

void add_measure_command(CLI::App& app, int& status) {
    CLI::App& verb = *app.add_subcommand("measure", "Measure the light that arrives at a point: W/m2 and lux");
    const auto flags = std::make_shared<MeasureFlags>();
    add_scene_name(verb, flags->scene);
    verb.add_option("--at", flags->at, "the point, metres")->type_name("X,Y,Z")->required();
    verb.add_option("--normal", flags->normal, "the normal of a surface there, of any length")
        ->type_name("X,Y,Z")
        ->required();
    flags->settings.add(verb, kMeasure, *flags);
    verb.get_option("--spp")->description("The number of samples; four times as many halve the error.");
    add_report_flags(verb, flags->report);
    verb.callback([flags, &status] { status = measure(*flags); });
}

} // namespace pertev
