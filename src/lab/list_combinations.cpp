#include "lab/list_combinations.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/error.h"
#include "lab/walk_kernels.h"
#include "render/place_meshes.h"

namespace pertev {
namespace {

CombinationFigures figures_of(const Combination& c, const LabMachine& machine) {
    CombinationFigures figures = {.combination = c, .name = name_of(c)};
    if (const auto reason = why_not(c, machine)) {
        figures.refused = *reason;
    } else if (find_kernel(c, false, machine.is_cuda) == nullptr) {
        figures.refused = !c.options.is_exact()    ? "fast and woop tests are compiled with rta and near alone"
                          : !c.options.rta_at_pops ? "RTA at nodes alone is compiled with near alone"
                                                   : "not compiled";
    }
    return figures;
}

} // namespace

LabMachine lab_machine(const Queue& queue, const Scene& scene) {
    return {queue.is_cuda(), place_meshes(scene).mesh_tree_count > 0};
}

std::vector<CombinationFigures> list_combinations(const LabSettings& settings, const LabMachine& machine) {
    std::vector<CombinationFigures> list;
    for (const Combination& c : settings.only) list.push_back(figures_of(c, machine));
    if (!settings.only.empty()) return list;
    bool brute_force_listed = false;
    for (const StructureKind structure : settings.structures) {
        for (const WalkKind walk : settings.walks) {
            if (walk == WalkKind::BruteForce && brute_force_listed) continue; // one array is as good as another
            brute_force_listed = brute_force_listed || (walk == WalkKind::BruteForce && builder_of(structure));
            if (!settings.by_name && why_not(structure, walk)) continue;
            for (const Distribution distribution : settings.distributions) {
                for (const WalkOptions& options : settings.options) {
                    list.push_back(figures_of({structure, walk, options, distribution}, machine));
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
    throw Error(ErrorCode::BadInput, "none of the combinations asked for can be measured:" + reasons);
}

} // namespace pertev
