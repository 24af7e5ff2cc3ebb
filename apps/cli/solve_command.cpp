// pertev solve radiosity SCENE -o FILE: light that does not depend on a camera, solved once for any number of pictures.

#include <filesystem>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "accel/builders/bvh_cache.h"
#include "apps/cli/commands.h"
#include "apps/cli/flag_checks.h"
#include "apps/cli/report_radiosity.h"
#include "apps/cli/report_result.h"
#include "apps/cli/scene_options.h"
#include "apps/cli/setting_flags.h"
#include "base/error.h"
#include "base/parallel_for.h"
#include "base/stopwatch.h"
#include "base/write_file_atomically.h"
#include "image/image_format.h"
#include "session/check_integrator.h"
#include "session/moving_scene.h"
#include "session/opening/strictness.h"
#include "session/writing/check_outputs.h"

namespace pertev {
namespace {

struct SolveFlags : PictureOptions {
    std::string output;
    SettingFlags settings;
    ReportFlags report;
};

/// Returns the solution's file name: "box.rad" for "box.png".
std::string solution_name(const std::string& picture) {
    return std::filesystem::path(picture).replace_extension(".rad").string();
}

int solve(SolveFlags& flags) {
    Reporter reporter(flags.report);
    flags.settings.read(flags, reporter);
    if (is_picture_name(flags.output)) {
        throw Error(ErrorCode::BadInput, "output", flags.output,
                    fmt::format("a solution is not a picture; write it with -o {0} and show it with pertev render "
                                "--integrator radiosity --solution {0}",
                                solution_name(flags.output)));
    }
    refuse_list(flags.output);
    note_number_signs(flags.output, reporter);
    check_writable(flags.output);
    const UseThreads threads(static_cast<int>(flags.machine.threads));
    const Stopwatch total_time;
    reporter.set_work(fmt::format("loading {}", flags.scene.scene));
    Scene scene = open_scene(flags.scene, reporter, SceneUse::Measurement);
    if (flags.strict) refuse_what_is_left_out(reporter, "nothing was solved");
    check_light(flags.render, scene, reporter);
    PrepareOptions prepare = prepare_options(flags.render, false);
    prepare.may_be_better = true;
    if (!flags.no_cache) prepare.bvh_cache = bvh_cache_folder();
    reporter.set_work("building trees");
    const MovingScene moving(std::move(scene), flags.time_s, prepare, reporter);
    reporter.report_messages();
    const SolvedRadiosity solved =
        solve_scene(moving.prepared(), flags.radiosity, flags.render.path.seed, reporter, report_solving(reporter));
    reporter.set_work("writing");
    reporter.write_output(flags.output, [&] { write_solution(flags.output, solved.solution); });
    const bool cut_short = solved.stats.was_interrupted;
    const std::string holds =
        cut_short ? fmt::format(", stopped early: it contains {}", describe(solved.solution.extent)) : "";
    const std::string hash = solved.solution.hash().hex();
    reporter.print(fmt::format("wrote {}{}: hash {}", flags.output, holds, hash));
    const SolveStats& stats = solved.stats;
    reporter.result(fmt::format(
        R"({{"event":"done","seconds":{:.6f},"total_seconds":{:.6f},"peak_bytes":{},"hash":"{}","interrupted":{}}})",
        stats.factor_seconds + stats.solve_seconds + stats.divide_seconds, total_time.seconds(), peak_memory_bytes(),
        hash, cut_short));
    return cut_short ? exit_status(ErrorCode::Interrupted) : 0;
}

} // namespace

void add_solve_command(CLI::App& app, int& status) {
    CLI::App& all = *app.add_subcommand("solve", "Solve a scene's light once, for any number of pictures");
    all.require_subcommand(1);
    CLI::App& verb = *all.add_subcommand(
        "radiosity", "Solve the light of diffuse surfaces by patches, for the integrator radiosity");
    const auto flags = std::make_shared<SolveFlags>();
    add_scene_name(verb, flags->scene);
    verb.add_option("-o,--output", flags->output, "the solution")->type_name("FILE")->check(file_name())->required();
    flags->render.integrator = IntegratorKind::Radiosity;
    flags->settings.add(verb, kSolve, *flags);
    add_report_flags(verb, flags->report);
    verb.callback([flags, &status] { status = solve(*flags); });
}

} // namespace pertev
