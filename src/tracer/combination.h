#pragma once

// How rays find what they hit: a structure, its traversal, the switches of both, and how rays are distributed to
// threads. Rendering chooses from these combinations, and the laboratory compares them. An invalid
// combination is refused with a reason.

#include <cstdint>
#include <optional>
#include <string>

#include "accel/builders/builders.h"
#include "base/value_names.h"
#include "trace/traversal/traversal_options.h"

namespace pertev {

enum class StructureKind {
    Binned,             // binary trees: SAH with bins,
    Sweep,              // SAH over every split position,
    Median,             // spatial median,
    EqualCounts,        // object median,
    SpatialSplits,      // SBVH,
    Ploc,               // PLOC, bottom-up,
    Hploc,              // H-PLOC, bottom-up, as a GPU builds it,
    Insertion,          // incremental insertion, one triangle after the other,
    Reinsertion,        // binned SAH, then optimized by reinsertion of subtrees,
    SpatialReinsertion, // SBVH, then optimized by reinsertion
    KdMedian,
    KdSah,
    Octree,
};

enum class TraversalKind {
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

/// Distribution of rays to threads. The CPU has only the first.
enum class Distribution {
    OneAThread,
    Persistent,   // enough warps to fill the GPU, each fetching rays from a pool
    DynamicFetch, // persistent warps in which finished lanes fetch new rays while the others go on
};

// Names of structures as text. Binary hierarchies have the names of their builders.
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
inline constexpr ValueName<TraversalKind> kTraversalNames[] = {{TraversalKind::IfIf, "if-if"},
                                                               {TraversalKind::WhileWhile, "while-while"},
                                                               {TraversalKind::Speculative, "speculative"},
                                                               {TraversalKind::Octants, "octants"},
                                                               {TraversalKind::BruteForce, "brute-force"},
                                                               {TraversalKind::RestartTrail, "restart-trail"},
                                                               {TraversalKind::ShortStack, "short-stack"},
                                                               {TraversalKind::ParentLinks, "parent-links"},
                                                               {TraversalKind::SkipLinks, "skip-links"},
                                                               {TraversalKind::Packet, "packet"},
                                                               {TraversalKind::Wide4, "wide4"},
                                                               {TraversalKind::Wide8, "wide8"},
                                                               {TraversalKind::Wide8Simd, "wide8-simd"},
                                                               {TraversalKind::Compressed, "compressed"},
                                                               {TraversalKind::Kd, "kd"},
                                                               {TraversalKind::Octree, "octree"}};
inline constexpr ValueName<Distribution> kDistributionNames[] = {{Distribution::OneAThread, "one-a-thread"},
                                                                 {Distribution::Persistent, "persistent"},
                                                                 {Distribution::DynamicFetch, "dynamic-fetch"}};
inline constexpr ValueName<TestKind> kTestNames[] = {
    {TestKind::Exact, "exact"}, {TestKind::Fast, "fast"}, {TestKind::Woop, "woop"}};
constexpr const auto& names_of_all(StructureKind) { return kStructureNames; }
constexpr const auto& names_of_all(TraversalKind) { return kTraversalNames; }
constexpr const auto& names_of_all(Distribution) { return kDistributionNames; }
constexpr const auto& names_of_all(TestKind) { return kTestNames; }

struct Combination {
    StructureKind structure = StructureKind::Binned;
    TraversalKind traversal = TraversalKind::WhileWhile;
    TraversalOptions options;
    Distribution distribution = Distribution::OneAThread;
    bool operator==(const Combination&) const = default;
};

/// The builder of a binary hierarchy; nothing for kd-trees and octrees.
std::optional<BvhBuilder> builder_of(StructureKind kind);

/// Name of the setting of RTA: "on", "nodes" (only at nodes) or "off".
const char* name_of_rta(const TraversalOptions& options);
/// Returns `options` with RTA set by `name`; nothing if the name is unknown.
std::optional<TraversalOptions> rta_named(const std::string& name, TraversalOptions options);
/// The full name, for example "sbvh while-while rta near persistent".
std::string name_of(const Combination& combination);

/// The only traversal for structures of this kind; nothing if there are several.
std::optional<TraversalKind> only_traversal_of(StructureKind structure);

/// Returns why the traversal cannot handle structures of this kind; nothing if it can.
std::optional<std::string> why_not(StructureKind structure, TraversalKind traversal);
/// Returns why the combination is invalid on this kind of device; nothing if it is valid.
std::optional<std::string> why_not(const Combination& combination, bool on_cuda);

} // namespace pertev
