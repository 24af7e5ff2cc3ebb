#pragma once

// How rays find what they meet: a structure, a walk of it, the switches of both, and how rays come to threads. What
// pictures choose from and the laboratory compares. Names are those of the command line. A combination that makes no
// sense says why.

#include <cstdint>
#include <optional>
#include <string>

#include "accel/builders/builders.h"
#include "base/value_names.h"
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

// Names are those of the command line. Structures that are binary hierarchies are called as their builders.
inline constexpr ValueName<StructureKind> kStructureNames[] = {
    {StructureKind::Binned, name_of(BvhBuilder::Binned)},
    {StructureKind::Sweep, name_of(BvhBuilder::Sweep)},
    {StructureKind::Median, name_of(BvhBuilder::Median)},
    {StructureKind::EqualCounts, name_of(BvhBuilder::EqualCounts)},
    {StructureKind::SpatialSplits, name_of(BvhBuilder::SpatialSplits)},
    {StructureKind::Ploc, name_of(BvhBuilder::Ploc)},
    {StructureKind::Hploc, name_of(BvhBuilder::Hploc)},
    {StructureKind::Insertion, name_of(BvhBuilder::Insertion)},
    {StructureKind::Reinsertion, name_of(BvhBuilder::Reinsertion)},
    {StructureKind::SpatialReinsertion, name_of(BvhBuilder::SpatialReinsertion)},
    {StructureKind::KdMedian, "kd-median"},
    {StructureKind::KdSah, "kd-sah"},
    {StructureKind::Octree, "octree"}};
inline constexpr ValueName<WalkKind> kWalkNames[] = {{WalkKind::IfIf, "if-if"},
                                                     {WalkKind::WhileWhile, "while-while"},
                                                     {WalkKind::Speculative, "speculative"},
                                                     {WalkKind::Octants, "octants"},
                                                     {WalkKind::BruteForce, "brute-force"},
                                                     {WalkKind::RestartTrail, "restart-trail"},
                                                     {WalkKind::ShortStack, "short-stack"},
                                                     {WalkKind::ParentLinks, "parent-links"},
                                                     {WalkKind::SkipLinks, "skip-links"},
                                                     {WalkKind::Packet, "packet"},
                                                     {WalkKind::Wide4, "wide4"},
                                                     {WalkKind::Wide8, "wide8"},
                                                     {WalkKind::Wide8Simd, "wide8-simd"},
                                                     {WalkKind::Compressed, "compressed"},
                                                     {WalkKind::Kd, "kd"},
                                                     {WalkKind::Octree, "octree"}};
inline constexpr ValueName<Distribution> kDistributionNames[] = {{Distribution::OneAThread, "one-a-thread"},
                                                                 {Distribution::Persistent, "persistent"},
                                                                 {Distribution::DynamicFetch, "dynamic-fetch"}};
inline constexpr ValueName<TestKind> kTestNames[] = {
    {TestKind::Exact, "exact"}, {TestKind::Fast, "fast"}, {TestKind::Woop, "woop"}};
constexpr const auto& names_of_all(StructureKind) { return kStructureNames; }
constexpr const auto& names_of_all(WalkKind) { return kWalkNames; }
constexpr const auto& names_of_all(Distribution) { return kDistributionNames; }
constexpr const auto& names_of_all(TestKind) { return kTestNames; }

struct Combination {
    StructureKind structure = StructureKind::Binned;
    WalkKind walk = WalkKind::WhileWhile;
    WalkOptions options;
    Distribution distribution = Distribution::OneAThread;
    bool operator==(const Combination&) const = default;
};

/// None for kd-trees and the octree: the others are binary hierarchies.
std::optional<BvhBuilder> builder_of(StructureKind kind);

/// "on", "nodes" (at nodes alone) or "off".
const char* name_of_rta(const WalkOptions& options);
/// `options` with RTA as that names it; nothing where nothing is named so.
std::optional<WalkOptions> rta_named(const std::string& name, WalkOptions options);
/// "sbvh while-while rta near persistent"
std::string name_of(const Combination& combination);

/// The walk that goes over structures of this kind; nothing where there are several.
std::optional<WalkKind> only_walk_of(StructureKind structure);

/// Whether the walk goes over trees of this kind at all; else why not.
std::optional<std::string> why_not(StructureKind structure, WalkKind walk);
/// Why the combination makes no sense on this kind of device; nothing when it does.
std::optional<std::string> why_not(const Combination& combination, bool on_cuda);

} // namespace pertev
