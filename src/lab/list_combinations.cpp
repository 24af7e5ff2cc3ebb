#include "lab/list_combinations.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/error.h"
#include "tracer/traversal_kernels.h"

namespace pertev {
namespace {

CombinationFigures figures_of(const Combination& c, bool on_cuda) {
    CombinationFigures figures = {.combination = c, .name = name_of(c)};
    if (const auto reason = why_no_tracer(c, on_cuda)) figures.refused = *reason;
    return figures;
}

} // namespace

std::vector<CombinationFigures> list_combinations(const LabSettings& settings, bool on_cuda) {
    std::vector<CombinationFigures> list;
    for (const Combination& c : settings.only) list.push_back(figures_of(c, on_cuda));
    if (!settings.only.empty()) return list;
    bool brute_force_listed = false;
    for (const StructureKind structure : settings.structures) {
        for (const TraversalKind traversal : settings.traversals) {
            if (traversal == TraversalKind::BruteForce && brute_force_listed)
                continue; // brute force does not depend on the
                          // structure, so it is listed once
            brute_force_listed =
                brute_force_listed || (traversal == TraversalKind::BruteForce && builder_of(structure));
            if (!settings.by_name && why_not(structure, traversal)) continue;
            for (const Distribution distribution : settings.distributions) {
                for (const TraversalOptions& options : settings.options) {
                    list.push_back(figures_of({structure, traversal, options, distribution}, on_cuda));
                }
            }
        }
    }
    return list;
}

void check_any_can_run(const std::vector<CombinationFigures>& combinations) {
    if (std::ranges::any_of(combinations, [](const CombinationFigures& c) { return c.refused.empty(); })) return;
    std::string reasons;
    for (const Refusal& refusal : refusals_by_reason(combinations)) {
        const std::size_t others = refusal.names.size() - 1;
        reasons += fmt::format("\n  {}{}: {}", refusal.names.front(),
                               others > 0 ? fmt::format(" and {} more", others) : "", refusal.reason);
    }
    throw Error(ErrorCode::BadInput, "traversal", "", "the requested combinations cannot be measured:" + reasons);
}

} // namespace pertev
