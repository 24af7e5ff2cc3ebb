#pragma once

// Every builder of the binary hierarchy, by name: what `pertev lab` chooses from. tracer/tracer_choice.h says
// which pictures are made with. All give trees that are functions of the triangles alone, whatever the number of
// threads, at most kMaxBvhDepth deep. Vertices are finite, |coordinate| <= kMaxCoordinate. Of the settings, max_leaf
// and the two costs count for all; `bins` and max_depth for Binned alone. Throw Error(OverLimit) for too many
// triangles.

#include <vector>

#include "accel/bvh/build_tree.h"
#include "accel/bvh/bvh.h"
#include "base/value_names.h"

namespace pertev {

enum class BvhBuilder {
    Binned,             // top down, surface area heuristic at the edges of bins: build_bvh.h
    Sweep,              // top down, surface area heuristic at every place
    Median,             // top down, middle of the longest side
    EqualCounts,        // top down, half of the triangles to each side
    SpatialSplits,      // top down, triangles may be cut too: a tree may hold one more than once
    Ploc,               // bottom up, clusters along a Morton curve
    Hploc,              // the same, in the parts that the curve has: what is built on a GPU (accel/hploc)
    Insertion,          // one triangle after the other, each where it adds least
    Reinsertion,        // Binned, then subtrees are moved to where they add least
    SpatialReinsertion, // SpatialSplits, then the same
};
/// These are the names that people type.
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

/// Whether the builder cuts triangles: a tree may then hold one more than once, in boxes that hold but a part of it.
/// find_split_fault checks such a tree, find_fault all others.
bool cuts_triangles(BvhBuilder builder);

Bvh build_bvh(BvhBuilder builder, const std::vector<BvhTriangle>& triangles, const BvhBuildSettings& settings = {});

Bvh build_sweep_bvh(const std::vector<BvhTriangle>& triangles, const BvhBuildSettings& settings = {});
Bvh build_median_bvh(const std::vector<BvhTriangle>& triangles, const BvhBuildSettings& settings = {});
Bvh build_equal_counts_bvh(const std::vector<BvhTriangle>& triangles, const BvhBuildSettings& settings = {});
Bvh build_ploc_bvh(const std::vector<BvhTriangle>& triangles, const BvhBuildSettings& settings = {});
Bvh build_hploc_bvh(const std::vector<BvhTriangle>& triangles, const BvhBuildSettings& settings = {});

Bvh build_insertion_bvh(const std::vector<BvhTriangle>& triangles, const BvhBuildSettings& settings = {});

struct SpatialSplitSettings {
    float min_overlap = 1e-5f; // triangles are cut where the halves of the best cut between triangles share more than
                               // this part of the root's area
    float min_own_overlap = 0.2f; // and more than this part of their parent's: less is seldom worth a look
    float max_growth = 1.0f;      // >= 0; at most (1 + this) references a triangle
};
Bvh build_spatial_split_bvh(const std::vector<BvhTriangle>& triangles, const BvhBuildSettings& settings = {},
                            const SpatialSplitSettings& splits = {});

struct ReinsertionSettings {
    int passes = 8;         // >= 0
    float part = 0.25f;     // (0, 1] of the nodes, those with the largest boxes, are tried in a pass
    float min_gain = 1e-3f; // a pass that lowers the sum of areas by less than this part of it is the last
};
/// Any sound tree, made better by moving subtrees; its cost does not rise, unless leaves held more than
/// settings.max_leaf or its depth has to be limited. A triangle that it holds more than once stays in as many boxes.
Bvh optimise_bvh(const Bvh& bvh, const BvhBuildSettings& settings = {}, const ReinsertionSettings& reinsertion = {});

Bvh build_spatial_reinsertion_bvh(const std::vector<BvhTriangle>& triangles, const BvhBuildSettings& settings = {});

} // namespace pertev
