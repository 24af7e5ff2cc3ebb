#pragma once

// The laboratory's combinations that tests trace, and the check of its report.

#include <doctest/doctest.h>

#include <algorithm>

#include "lab/run_lab.h"
#include "tests/support/traversal_switches.h"

namespace pertev::test {

/// Returns all combinations on a device, with brute force only for a small scene.
inline LabSettings all_combinations(bool is_cuda, bool brute_force) {
    LabSettings settings;
    settings.structures.assign(kValuesOf<StructureKind>.begin(), kValuesOf<StructureKind>.end());
    settings.traversals.assign(kValuesOf<TraversalKind>.begin(), kValuesOf<TraversalKind>.end());
    if (!brute_force) std::erase(settings.traversals, TraversalKind::BruteForce);
    settings.options = exact_options();
    if (is_cuda) {
        settings.distributions = {Distribution::OneAThread, Distribution::Persistent, Distribution::DynamicFetch};
    }
    settings.runs = settings.warm_ups = 0;
    settings.heat_maps = false;
    return settings;
}

/// Tests that at least `least` combinations were traced and that none of them differs from the reference traversal.
inline void check_report(const LabReport& report, uint64_t least = 40) {
    uint64_t checked = 0;
    for (const CombinationFigures& c : report.combinations) {
        CAPTURE(c.name);
        CAPTURE(c.refused);
        CHECK_FALSE(c.refused.starts_with("WRONG"));
        CHECK_FALSE(c.refused == "not compiled");
        for (const RunFigures& run : c.runs) CHECK(run.different == 0);
        checked += c.runs.empty() ? 0 : 1;
    }
    CHECK(checked >= least);
}

} // namespace pertev::test
