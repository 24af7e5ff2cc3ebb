#pragma once

// All builders of the binary hierarchy by name. `pertev lab` chooses among them, and tracer/tracer_choice.h says
// which of them rendering uses. Each tree depends only on the triangles, not on the number of threads, and is at most
// kMaxBvhDepth deep. Vertices are finite, |coordinate| <= kMaxCoordinate. All builders use max_leaf and the two costs
// of the settings; only Binned uses `bins` and max_depth. Too many triangles throw Error(OverLimit).

#include <vector>

#include "accel/bvh/build_tree.h"
#include "accel/bvh/bvh.h"
#include "base/value_names.h"

namespace pertev {

enum class BvhBuilder {
    Binned,             // top-down, binned surface area heuristic: build_bvh.h
    Sweep,              // top-down, surface area heuristic at every position
    Median,             // top-down, spatial median of the longest side
    EqualCounts,        // top-down, object median
    SpatialSplits,      // top-down with split triangles: a tree may hold a triangle more than once
    Ploc,               // bottom-up clustering along a Morton curve
    Hploc,              // PLOC within the ranges of the curve's radix tree, as a GPU builds it (accel/hploc)
    Insertion,          // incremental: each triangle goes where it adds the least area
    Reinsertion,        // Binned, then optimized by reinsertion of subtrees
    SpatialReinsertion, // SpatialSplits, then optimized by reinsertion
};
/// Names of builders as text.
inline constexpr ValueName<BvhBuilder> kBvhBuilders[] = {{BvhBuilder::Binned, "binned"},
                                                         {BvhBuilder::Sweep, "sweep"},
                                                         {BvhBuilder::Median, "median"},
                                                         {BvhBuilder::EqualCounts, "equal-counts"},
                                                         {BvhBuilder::SpatialSplits, "sbvh"},
                                                         {BvhBuilder::Ploc, "ploc"},
                                                         {BvhBuilder::Hploc, "hploc"},
                                                         {BvhBuilder::Insertion, "insertion"},
                                                         {BvhBuilder::Reinsertion, "reinsertion"},
                                                         {BvhBuilder::SpatialReinsertion, "sbvh-reinsertion"}};
constexpr const auto& names_of_all(BvhBuilder) { return kBvhBuilders; }

/// Returns whether the builder splits triangles. Its trees may hold a triangle more than once, in boxes that hold only
/// a part of it.
bool cuts_triangles(BvhBuilder builder);

Bvh build_bvh(BvhBuilder builder, const std::vector<BvhTriangle>& triangles, const BvhBuildSettings& settings = {});

Bvh build_sweep_bvh(const std::vector<BvhTriangle>& triangles, const BvhBuildSettings& settings = {});
Bvh build_median_bvh(const std::vector<BvhTriangle>& triangles, const BvhBuildSettings& settings = {});
Bvh build_equal_counts_bvh(const std::vector<BvhTriangle>& triangles, const BvhBuildSettings& settings = {});
Bvh build_ploc_bvh(const std::vector<BvhTriangle>& triangles, const BvhBuildSettings& settings = {});
Bvh build_hploc_bvh(const std::vector<BvhTriangle>& triangles, const BvhBuildSettings& settings = {});

Bvh build_insertion_bvh(const std::vector<BvhTriangle>& triangles, const BvhBuildSettings& settings = {});

struct SpatialSplitSettings {
    float min_overlap = 1e-5f; // triangles are split if the halves of the best object split overlap by more than this
                               // fraction of the root's area
    float min_own_overlap = 0.2f; // least overlap as a fraction of the parent's; a smaller one is seldom
                                  // worth a split
    float max_growth = 1.0f;      // >= 0; at most (1 + this) references per triangle
};
Bvh build_spatial_split_bvh(const std::vector<BvhTriangle>& triangles, const BvhBuildSettings& settings = {},
                            const SpatialSplitSettings& splits = {});

struct ReinsertionSettings {
    int passes = 8;         // >= 0
    float part = 0.25f;     // (0, 1]; fraction of the nodes, those with the largest boxes, that a pass tries
    float min_gain = 1e-3f; // the last pass is one that reduces the sum of areas by less than this fraction
};
/// Optimizes any valid tree by reinsertion of subtrees. Its cost does not rise, unless leaves held more than
/// settings.max_leaf triangles or its depth must be limited. A triangle that it holds several times keeps as many
/// boxes.
Bvh optimise_bvh(const Bvh& bvh, const BvhBuildSettings& settings = {}, const ReinsertionSettings& reinsertion = {});

Bvh build_spatial_reinsertion_bvh(const std::vector<BvhTriangle>& triangles, const BvhBuildSettings& settings = {});

} // namespace pertev
