#pragma once

// Switches of traversals with exact tests, and the trees over which tests trace all of them.

#include <vector>

#include "tracer/combination.h"

namespace pertev::test {

inline std::vector<TraversalOptions> exact_options() {
    std::vector<TraversalOptions> options;
    for (const bool rta : {true, false}) {
        for (const bool near_first : {true, false}) options.push_back({.rta = rta, .near_first = near_first});
    }
    options.push_back({.rta_at_pops = false});
    return options;
}

inline bool is_switched_on(const TraversalOptions& options) {
    return options.rta && options.near_first && options.rta_at_pops;
}

/// Returns whether every traversal is tested over the structure with every switch. Trees of the other builders are
/// traversed by the same code as those with spatial splits, so most switches need no separate test.
inline bool is_first_tree(StructureKind structure) {
    return structure == StructureKind::SpatialSplits || !builder_of(structure);
}

} // namespace pertev::test
