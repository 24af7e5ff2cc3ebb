#include "apps/cli/report_radiosity.h"

#include <algorithm>

#include <fmt/format.h>

#include "apps/cli/interrupt.h"
#include "apps/cli/report_result.h"
#include "base/machine_memory.h"
#include "base/message_text.h"

namespace pertev {
namespace {

void report_begin(const SolveMemory& memory, float patch_size_m, Reporter& reporter) {
    reporter.print(
        fmt::format("radiosity: at most {} {} with edges up to {:.4g} m, in at most {:.0f} MiB of host memory",
                    memory.patches, memory.patches == 1 ? "patch" : "patches", patch_size_m, mebibytes(memory.bytes)));
    reporter.event(fmt::format(
        R"({{"event":"radiosity","most_patches":{},"most_shown":{},"patch_size":{},"predicted_bytes":{},"peak_bytes":{}}})",
        memory.patches, memory.shown, patch_size_m, memory.bytes, peak_memory_bytes()));
    listen_for_interrupt();
}

void report_end(const SolvedRadiosity& solved, Reporter& reporter) {
    reporter.end_progress();
    const SolveStats& stats = solved.stats;
    reporter.print(
        fmt::format("{} shooting patches, {} displayed; {} form factors ({:.0f} bytes per patch) in {:.2f} s, {} "
                    "{:.2f} s ({} steps, {:.2g} unsolved), subdivided in {:.2f} s",
                    stats.patches, stats.shown, stats.factors,
                    static_cast<double>(stats.bytes) / static_cast<double>(std::max<uint64_t>(stats.patches, 1)),
                    stats.factor_seconds, stats.was_interrupted ? "interrupted after solving for" : "solved in",
                    stats.solve_seconds, stats.steps, stats.left, stats.divide_seconds));
    reporter.event(fmt::format(
        R"({{"event":"radiosity_solved","patches":{},"shown":{},"form_factors":{},"bytes":{},"peak_bytes":{},"steps":{},"left":{},"reached_limit":{},"link_error":{},"factor_seconds":{:.3f},"solve_seconds":{:.3f},"divide_seconds":{:.3f},"hash":{},"interrupted":{},"holds":{}}})",
        stats.patches, stats.shown, stats.factors, stats.bytes, peak_memory_bytes(), stats.steps,
        json_number(stats.left), stats.reached_limit,
        stats.link_error > 0 ? fmt::format("{}", stats.link_error) : "null", stats.factor_seconds, stats.solve_seconds,
        stats.divide_seconds, json_string(solved.solution.hash().hex()), stats.was_interrupted,
        stats.was_interrupted ? json_string(describe(solved.solution.extent)) : "null"));
}

} // namespace

SolveReport report_solving(Reporter& reporter) {
    return {.begin = [&](const SolveMemory& memory, float size_m) { report_begin(memory, size_m, reporter); },
            .end = [&](const SolvedRadiosity& solved) { report_end(solved, reporter); }};
}

} // namespace pertev
