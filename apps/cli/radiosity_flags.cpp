#include "apps/cli/radiosity_flags.h"

#include <algorithm>
#include <filesystem>

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
#include "settings/value_names.h"

namespace pertev {

RadiositySettings radiosity_settings(const RadiosityOptions& options, uint32_t seed) {
    RadiositySettings settings = options.solving;
    settings.seed = seed;
    settings.hemicube = settings.hemicube / 2 * 2; // the sides have half of them
    refuse(settings.solver == RadiositySolver::Hierarchical && settings.form_factors == FormFactors::Hemicube,
           "--form-factors hemicube: --solver hierarchical finds its links by rays; leave out one of them");
    return settings;
}

void check_radiosity_flags(const RadiosityOptions& options, const RenderSettings& settings, bool limits_memory) {
    if (settings.integrator != IntegratorKind::Radiosity) {
        refuse(options.max_memory > 0 && !limits_memory,
               fmt::format("--max-memory: applies to --integrator radiosity; {} has no patches",
                           integrator_name(settings)));
        return;
    }
    refuse(options.max_memory > 0 && !limits_memory && !options.solution.empty(),
           "--max-memory: --solution has been solved already; leave out one of them");
    refuse(!options.solution.empty() && !std::filesystem::exists(options.solution),
           fmt::format("--solution {}: there is no such file", options.solution));
    radiosity_settings(options, 0);
}

std::optional<std::size_t> max_memory_bytes(const RadiosityOptions& options) {
    if (!(options.max_memory > 0)) return std::nullopt;
    return static_cast<std::size_t>(std::min(options.max_memory * 0x1p20, 0x1p62));
}

SolvedRadiosity solve_and_report(const PreparedScene& prepared, const RadiosityOptions& options, uint32_t seed,
                                 Reporter& reporter) {
    const RadiositySettings settings = radiosity_settings(options, seed);
    reporter.set_work("solving radiosity");
    const SolveMemory memory = predict_memory(prepared, settings, thread_count());
    reporter.print(fmt::format("radiosity: at most {} of {:.4g} m, {:.0f} MiB of this machine's memory",
                               fmt::format("{} {}", memory.patches, memory.patches == 1 ? "patch" : "patches"),
                               patch_size_of(prepared, settings), mebibytes(memory.bytes)));
    const uint64_t before = peak_memory_bytes();
    reporter.event(fmt::format(
        R"({{"event":"radiosity","most_patches":{},"most_shown":{},"patch_size":{},"predicted_bytes":{},"peak_bytes":{}}})",
        memory.patches, memory.shown, patch_size_of(prepared, settings), memory.bytes, before));
    check_memory(memory, settings, max_memory_bytes(options).value_or(machine_memory_bytes()));
    listen_for_interrupt();
    SolvedRadiosity solved = solve_radiosity(prepared, settings, reporter);
    reporter.end_progress();
    const SolveStats& stats = solved.stats;
    reporter.print(
        fmt::format("{} patches send, {} are shown; {} form factors ({:.0f} bytes a patch) in {:.2f} s, "
                    "{} {:.2f} s ({} steps, {:.2g} left), divided in {:.2f} s",
                    stats.patches, stats.shown, stats.factors,
                    static_cast<double>(stats.bytes) / static_cast<double>(std::max<uint64_t>(stats.patches, 1)),
                    stats.factor_seconds, stats.was_interrupted ? "ended after solving for" : "solved in",
                    stats.solve_seconds, stats.steps, stats.left, stats.divide_seconds));
    warn_of_limits(stats, settings, reporter.messages());
    reporter.report_messages();
    reporter.event(fmt::format(
        R"({{"event":"radiosity_solved","patches":{},"shown":{},"form_factors":{},"bytes":{},"peak_bytes":{},"steps":{},"left":{},"reached_limit":{},"link_error":{},"factor_seconds":{:.3f},"solve_seconds":{:.3f},"divide_seconds":{:.3f},"hash":{},"interrupted":{},"holds":{}}})",
        stats.patches, stats.shown, stats.factors, stats.bytes, peak_memory_bytes(), stats.steps,
        json_number(stats.left), stats.reached_limit,
        stats.link_error > 0 ? fmt::format("{}", stats.link_error) : "null", stats.factor_seconds, stats.solve_seconds,
        stats.divide_seconds, json_string(solved.solution.hash().hex()), stats.was_interrupted,
        stats.was_interrupted ? json_string(describe(solved.solution.extent)) : "null"));
    return solved;
}

RadiosityDisplay radiosity_display(const RadiosityOptions& options, const PreparedScene& prepared, uint32_t seed,
                                   Reporter& reporter) {
    const auto display = [&](RadiositySolution&& solution) {
        return RadiosityDisplay{std::make_shared<const RadiositySolution>(std::move(solution)), options.flat_patches};
    };
    if (!options.solution.empty()) {
        RadiositySolution solution = read_solution(options.solution, *prepared.scene, reporter.messages());
        reporter.report_messages();
        return display(std::move(solution));
    }
    SolvedRadiosity solved = solve_and_report(prepared, options, seed, reporter);
    if (solved.stats.was_interrupted) { // a picture of it could not be made again
        throw Error(ErrorCode::Interrupted, "interrupted while radiosity was solved, so that there is nothing to show "
                                            "(pertev solve radiosity keeps what has been solved by then)");
    }
    return display(std::move(solved.solution));
}

} // namespace pertev
