#include "lab/lab_report.h"

#include <algorithm>

namespace pertev {

std::vector<Refusal> refusals_by_reason(const std::vector<CombinationFigures>& combinations) {
    std::vector<Refusal> refusals;
    for (const CombinationFigures& c : combinations) {
        if (c.refused.empty() || c.wrong) continue;
        const auto at = std::ranges::find(refusals, c.refused, &Refusal::reason);
        if (at == refusals.end()) {
            refusals.push_back({c.refused, {c.name}});
        } else {
            at->names.push_back(c.name);
        }
    }
    return refusals;
}

bool has_findings(const LabReport& report) {
    return std::ranges::any_of(report.combinations,
                               [](const CombinationFigures& c) { return c.wrong || !c.runs.empty(); });
}

const RunFigures* find_run(const CombinationFigures& combination, uint32_t set) {
    const auto at = std::ranges::find_if(combination.runs, [set](const RunFigures& run) { return run.set == set; });
    return at == combination.runs.end() ? nullptr : &*at;
}

std::optional<double> frame_seconds(const LabReport& report, const CombinationFigures& combination, int depth) {
    double seconds = 0;
    int found = 0;
    for (const RunFigures& run : combination.runs) {
        const int at = report.sets[run.set].depth;
        if (at < 1 || at > depth) continue;
        seconds += run.median_s;
        ++found;
    }
    return found == depth && seconds > 0 ? std::optional(seconds) : std::nullopt;
}

uint64_t frame_rays(const LabReport& report, int depth) {
    uint64_t rays = 0;
    for (const SetFigures& set : report.sets) rays += set.depth >= 1 && set.depth <= depth ? set.rays : 0;
    return rays;
}

int largest_depth(const LabReport& report) {
    int depth = 0;
    for (const SetFigures& set : report.sets) depth = std::max(depth, set.depth);
    return depth;
}

} // namespace pertev
