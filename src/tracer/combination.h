#pragma once

// How rays find what they meet: a structure, a walk of it, the switches of both, and how rays come to threads. What
// pictures choose from and the laboratory compares. Names are those of the command line. A combination that makes no
// sense says why.

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "accel/builders/builders.h"
#include "trace/traversal/walk_options.h"

namespace pertev {

enum class StructureKind {
    Binned,             // binary trees: SAH over bins,
    Sweep,              // SAH over every cut,
    Median,             // halves of space,
    EqualCounts,        // halves of the triangles,
    SpatialSplits,      // SBVH,
    Ploc,               // bottom-up,
    Hploc,              // bottom-up, as a GPU builds it,
    Insertion,          // one triangle after the other,
    Reinsertion,        // binned, then improved by moving subtrees,
    SpatialReinsertion, // SBVH, then the same
    KdMedian,
    KdSah,
    Octree,
};

enum class WalkKind {
    IfIf,
    WhileWhile,
    Speculative,
    Octants,
    BruteForce,
    RestartTrail,
    ShortStack,
    ParentLinks,
    SkipLinks,
    Packet,
    Wide4,
    Wide8,
    Wide8Simd,
    Compressed,
    Kd,
    Octree,
};

/// How rays come to threads. Only the first exists on the CPU.
enum class Distribution {
    OneAThread,
    Persistent,   // as many warps as the GPU holds, each fetching rays from a pool
    DynamicFetch, // the same, and lanes that are done get new rays while the others go on
};

struct Combination {
    StructureKind structure = StructureKind::Binned;
    WalkKind walk = WalkKind::WhileWhile;
    WalkOptions options;
    Distribution distribution = Distribution::OneAThread;
    bool operator==(const Combination&) const = default;
};

/// All there are, in the order above.
std::span<const StructureKind> all_structures();
std::span<const WalkKind> all_walks();
std::span<const TestKind> all_tests();

/// None for kd-trees and the octree: the others are binary hierarchies.
std::optional<BvhBuilder> builder_of(StructureKind kind);

const char* name_of(StructureKind kind);
const char* name_of(WalkKind kind);
const char* name_of(Distribution distribution);
const char* name_of(TestKind kind);
/// "on", "nodes" (at nodes alone) or "off".
const char* name_of_rta(const WalkOptions& options);
/// `options` with RTA as that names it; nothing where nothing is named so.
std::optional<WalkOptions> rta_named(const std::string& name, WalkOptions options);
/// "sbvh while-while rta near persistent"
std::string name_of(const Combination& combination);

/// Nothing when no kind is named so.
std::optional<StructureKind> structure_named(const std::string& name);
std::optional<WalkKind> walk_named(const std::string& name);
std::optional<Distribution> distribution_named(const std::string& name);

/// The walk that goes over structures of this kind; nothing where there are several.
std::optional<WalkKind> only_walk_of(StructureKind structure);

/// Whether the walk goes over trees of this kind at all; else why not.
std::optional<std::string> why_not(StructureKind structure, WalkKind walk);
/// Why the combination makes no sense on this kind of device; nothing when it does.
std::optional<std::string> why_not(const Combination& combination, bool on_cuda);

} // namespace pertev
