#include "apps/cli/radiosity_flags.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "apps/cli/flag_checks.h"
#include "apps/cli/interrupt.h"
#include "apps/cli/report_result.h"
#include "base/byte_units.h"
#include "base/error.h"
#include "base/machine_memory.h"
#include "base/parallel_for.h"
#include "base/stopwatch.h"
#include "radiosity/solve_memory.h"
#include "session/settings_text.h"

namespace pertev {
namespace {

/// The first that is given. `with_memory`: of --max-memory too.
std::pair<const char*, bool> given_flags_of_solving(const RadiosityFlags& flags, bool with_memory) {
    for (const auto& [flag, is_given] :
         {std::pair("--patch-size", flags.patch_size > 0), std::pair("--subdivisions", flags.subdivisions.has_value()),
          std::pair("--contrast", flags.contrast > 0), std::pair("--form-factors", !flags.form_factors.empty()),
          std::pair("--patch-rays", flags.rays > 0), std::pair("--hemicube", flags.hemicube > 0),
          std::pair("--solver", !flags.solver.empty()), std::pair("--tolerance", flags.tolerance > 0),
          std::pair("--steps", flags.steps > 0), std::pair("--link-error", flags.link_error > 0),
          std::pair("--max-memory", with_memory && flags.max_memory > 0)}) {
        if (is_given) return {flag, true};
    }
    return {"", false};
}

} // namespace

void add_solving_flags(CLI::App& verb, RadiosityFlags& flags, const char* group) {
    const RadiositySettings defaults;
    verb.add_option("--patch-size", flags.patch_size,
                    "of radiosity: no edge of a patch is longer (a 16th of the\nscene's longest side)")
        ->type_name("METRES")
        ->check(length_m())
        ->group(group);
    verb.add_option("--subdivisions", flags.subdivisions,
                    fmt::format("of radiosity: how often patches are divided where light\nchanges over them ({})",
                                defaults.subdivisions))
        ->type_name("N")
        ->check(whole_between(0, kMostSubdivisions))
        ->group(group);
    verb.add_option("--contrast", flags.contrast,
                    fmt::format("of radiosity: it changes there, by this share ({})", defaults.contrast))
        ->type_name("X")
        ->check(number_above_zero())
        ->group(group);
    verb.add_option("--form-factors", flags.form_factors,
                    fmt::format("of radiosity: rays or hemicube, which hierarchical has not ({})",
                                name_of(defaults.form_factors)))
        ->type_name("NAME")
        ->check(one_of(form_factor_names()))
        ->group(group);
    verb.add_option("--patch-rays", flags.rays, fmt::format("of radiosity: rays of a patch ({})", defaults.rays))
        ->type_name("N")
        ->check(whole_between(kLeastPatchRays, kMostPatchRays))
        ->group(group);
    verb.add_option("--hemicube", flags.hemicube,
                    fmt::format("of radiosity by hemicubes: pixels along an edge of the top ({})", defaults.hemicube))
        ->type_name("PIXELS")
        ->check(whole_between(kLeastHemicube, kMostHemicube))
        ->group(group);
    verb.add_option(
            "--solver", flags.solver,
            fmt::format("of radiosity: gauss-seidel, southwell (progressive refinement),\nmatrix or hierarchical ({})",
                        name_of(defaults.solver)))
        ->type_name("NAME")
        ->check(one_of(solver_names()))
        ->group(group);
    verb.add_option("--tolerance", flags.tolerance,
                    fmt::format("of radiosity: share of the light that may be left ({})", defaults.tolerance))
        ->type_name("X")
        ->check(number_above_zero(1))
        ->group(group);
    verb.add_option("--steps", flags.steps,
                    "of southwell: at most so many patches send; what is left is\nshown as ambient light (any number)")
        ->type_name("N")
        ->check(whole_between(1, UINT32_MAX))
        ->group(group);
    verb.add_option("--link-error", flags.link_error,
                    fmt::format("of hierarchical: a link may be wrong by this share of the mean\nlight ({})",
                                defaults.link_error))
        ->type_name("X")
        ->check(number_above_zero())
        ->group(group);
    verb.add_option("--max-memory", flags.max_memory,
                    "refuse what takes more: radiosity of this machine's memory\n(all there is), pertev render of the "
                    "device's too")
        ->type_name("MIB")
        ->check(number_above_zero())
        ->group(group);
}

void add_radiosity_flags(CLI::App& verb, RadiosityFlags& flags, const char* group) {
    add_solving_flags(verb, flags, group);
    verb.add_option("--solution", flags.solution,
                    "of radiosity: a file that pertev solve radiosity wrote (the\nscene is solved first)")
        ->type_name("FILE")
        ->check(file_name())
        ->group(group);
    verb.add_flag("--flat-patches", flags.flat_patches, "of radiosity: each patch evenly lit, as it was solved")
        ->group(group);
}

RadiositySettings radiosity_settings(const RadiosityFlags& flags, uint32_t seed) {
    RadiositySettings settings;
    settings.patch_size = flags.patch_size;
    settings.seed = seed;
    if (flags.subdivisions) settings.subdivisions = *flags.subdivisions;
    if (flags.contrast > 0) settings.contrast = flags.contrast;
    if (flags.tolerance > 0) settings.tolerance = flags.tolerance;
    if (flags.rays > 0) settings.rays = flags.rays;
    if (flags.hemicube > 0) settings.hemicube = flags.hemicube / 2 * 2; // the sides have half of them
    if (!flags.form_factors.empty()) settings.form_factors = *form_factors_named(flags.form_factors);
    if (!flags.solver.empty()) settings.solver = *solver_named(flags.solver);
    settings.steps = flags.steps;
    if (flags.link_error > 0) settings.link_error = flags.link_error;
    refuse(flags.link_error > 0 && settings.solver != RadiositySolver::Hierarchical,
           "--link-error: of --solver hierarchical");
    refuse(flags.hemicube > 0 && settings.form_factors != FormFactors::Hemicube,
           "--hemicube: of --form-factors hemicube");
    refuse(settings.solver == RadiositySolver::Hierarchical && settings.form_factors == FormFactors::Hemicube,
           "--form-factors hemicube: --solver hierarchical has links in place of rows, whose light is found by rays; "
           "leave out one of them");
    refuse(flags.steps > 0 && settings.solver != RadiositySolver::Southwell, "--steps: of --solver southwell");
    refuse(flags.tolerance > 0 && settings.solver == RadiositySolver::Matrix,
           "--tolerance: --solver matrix leaves nothing; leave out one of them");
    refuse(flags.contrast > 0 && settings.subdivisions == 0, "--contrast: with --subdivisions 0 no patch is divided");
    return settings;
}

void check_radiosity_flags(const RadiosityFlags& flags, IntegratorKind integrator, const std::string& name,
                           bool limits_memory) {
    const auto [flag, is_given] = given_flags_of_solving(flags, !limits_memory);
    if (integrator != IntegratorKind::Radiosity) {
        refuse(is_given, fmt::format("{}: of --integrator radiosity; {} has no patches", flag, name));
        refuse(!flags.solution.empty(), fmt::format("--solution: of --integrator radiosity; {} has none", name));
        refuse(flags.flat_patches, fmt::format("--flat-patches: of --integrator radiosity; {} has none", name));
        return;
    }
    refuse(is_given && !flags.solution.empty(),
           fmt::format("{}: --solution has been solved already; leave out one of them", flag));
    refuse(!flags.solution.empty() && !std::filesystem::exists(flags.solution),
           fmt::format("--solution {}: there is no such file", flags.solution));
    radiosity_settings(flags, 0);
}

std::optional<std::size_t> max_memory_bytes(const RadiosityFlags& flags) {
    if (!(flags.max_memory > 0)) return std::nullopt;
    return static_cast<std::size_t>(std::min(flags.max_memory * 0x1p20, 0x1p62));
}

namespace {

/// Shows how far each step is, and what is left of it.
class StepProgress {
public:
    explicit StepProgress(Reporter& reporter) : reporter_(reporter) {}

    void show(const char* what, double share) {
        if (what_ != what) {
            what_ = what;
            first_ = share;
            step_watch_.restart();
        }
        const double done = share - first_, seconds = step_watch_.seconds();
        const double left = done > 0.01 && seconds > 1 ? seconds * (1 - share) / done : -1;
        reporter_.progress(share, left >= 0 ? fmt::format("{}, {:.0f} s left", what, left) : what);
        reporter_.event(
            fmt::format(R"({{"event":"progress","seconds":{:.3f},"step":{},"share":{:.4f},"seconds_left":{}}})",
                        watch_.seconds(), json_string(what_), share, left >= 0 ? fmt::format("{:.3f}", left) : "null"));
    }

private:
    Reporter& reporter_;
    std::string what_;
    double first_ = 0;
    Stopwatch watch_, step_watch_;
};

} // namespace

SolvedRadiosity solve_and_report(const PreparedScene& prepared, const RadiosityFlags& flags, uint32_t seed,
                                 Reporter& reporter) {
    const RadiositySettings settings = radiosity_settings(flags, seed);
    reporter.set_work("solving radiosity");
    const SolveMemory memory = predict_memory(prepared, settings, thread_count());
    reporter.say(fmt::format("radiosity: at most {} of {:.4g} m, {:.0f} MiB of this machine's memory",
                             fmt::format("{} {}", memory.patches, memory.patches == 1 ? "patch" : "patches"),
                             patch_size_of(prepared, settings), mebibytes(memory.bytes)));
    const uint64_t before = peak_memory_bytes();
    reporter.event(fmt::format(
        R"({{"event":"radiosity","most_patches":{},"most_shown":{},"patch_size":{},"predicted_bytes":{},"peak_bytes":{}}})",
        memory.patches, memory.shown, patch_size_of(prepared, settings), memory.bytes, before));
    check_memory(memory, settings, max_memory_bytes(flags).value_or(machine_memory_bytes()));
    listen_for_interrupt();
    StepProgress progress(reporter);
    SolvedRadiosity solved = solve_radiosity(prepared, settings, [&](const char* what, double share) {
        progress.show(what, share);
        return !interrupted();
    });
    reporter.end_progress();
    const SolveStats& stats = solved.stats;
    reporter.say(
        fmt::format("{} patches send, {} are shown; {} form factors ({:.0f} bytes a patch) in {:.2f} s, "
                    "{} {:.2f} s ({} steps, {:.2g} left), divided in {:.2f} s",
                    stats.patches, stats.shown, stats.factors,
                    static_cast<double>(stats.bytes) / static_cast<double>(std::max<uint64_t>(stats.patches, 1)),
                    stats.factor_seconds, stats.was_interrupted ? "ended after solving for" : "solved in",
                    stats.solve_seconds, stats.steps, stats.left, stats.divide_seconds));
    warn_of_limits(stats, settings, reporter.messages());
    reporter.say_messages();
    reporter.event(fmt::format(
        R"({{"event":"radiosity_solved","patches":{},"shown":{},"form_factors":{},"bytes":{},"peak_bytes":{},"steps":{},"left":{},"reached_limit":{},"link_error":{},"factor_seconds":{:.3f},"solve_seconds":{:.3f},"divide_seconds":{:.3f},"hash":{},"interrupted":{},"holds":{}}})",
        stats.patches, stats.shown, stats.factors, stats.bytes, peak_memory_bytes(), stats.steps,
        json_number(stats.left), stats.reached_limit,
        stats.link_error > 0 ? fmt::format("{}", stats.link_error) : "null", stats.factor_seconds, stats.solve_seconds,
        stats.divide_seconds, json_string(solved.solution.hash().hex()), stats.was_interrupted,
        stats.was_interrupted ? json_string(describe(solved.solution.extent)) : "null"));
    return solved;
}

RadiosityLook radiosity_look(const RadiosityFlags& flags, const PreparedScene& prepared, uint32_t seed,
                             Reporter& reporter) {
    const auto look = [&](RadiositySolution&& solution) {
        return RadiosityLook{std::make_shared<const RadiositySolution>(std::move(solution)), flags.flat_patches};
    };
    if (!flags.solution.empty()) {
        RadiositySolution solution = read_solution(flags.solution, *prepared.scene, reporter.messages());
        reporter.say_messages();
        return look(std::move(solution));
    }
    SolvedRadiosity solved = solve_and_report(prepared, flags, seed, reporter);
    if (solved.stats.was_interrupted) { // a picture of it could not be made again
        throw Error(ErrorCode::Interrupted, "interrupted while radiosity was solved, so that there is nothing to show "
                                            "(pertev solve radiosity keeps what has been solved by then)");
    }
    return look(std::move(solved.solution));
}

} // namespace pertev
