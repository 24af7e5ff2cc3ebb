#include "tracer/combination.h"

#include <utility>

#include <fmt/format.h>

namespace pertev {
namespace {

bool is_kd(StructureKind kind) { return kind == StructureKind::KdMedian || kind == StructureKind::KdSah; }

/// Returns whether the traversal can visit the nearer child first.
bool has_order(TraversalKind traversal) {
    return traversal != TraversalKind::BruteForce && traversal != TraversalKind::SkipLinks;
}

} // namespace

std::optional<BvhBuilder> builder_of(StructureKind kind) { return value_named<BvhBuilder>(name_of(kind)); }

const char* name_of_rta(const TraversalOptions& options) {
    return !options.rta ? "off" : options.rta_at_pops ? "on" : "nodes";
}

std::optional<TraversalOptions> rta_named(const std::string& name, TraversalOptions options) {
    for (const auto& [rta, rta_at_pops] : {std::pair(true, true), std::pair(true, false), std::pair(false, true)}) {
        options.rta = rta;
        options.rta_at_pops = rta_at_pops;
        if (name == name_of_rta(options)) return options;
    }
    return std::nullopt;
}

std::string name_of(const Combination& c) {
    std::string name = fmt::format("{} {}", name_of(c.structure), name_of(c.traversal));
    name += !c.options.rta ? " no-rta" : c.options.rta_at_pops ? " rta" : " rta-at-nodes";
    // A traversal without an order is named without one. If its switch is off, "unordered" is part of the name,
    // because that combination is refused and its message needs a name.
    if (has_order(c.traversal) || !c.options.near_first) name += c.options.near_first ? " near" : " unordered";
    if (!c.options.is_exact()) name += fmt::format(" {}-tests", name_of(c.options.tests));
    if (c.distribution != Distribution::OneAThread) name += fmt::format(" {}", name_of(c.distribution));
    return name;
}

std::optional<TraversalKind> only_traversal_of(StructureKind structure) {
    if (is_kd(structure)) return TraversalKind::Kd;
    if (structure == StructureKind::Octree) return TraversalKind::Octree;
    return std::nullopt;
}

std::optional<std::string> why_not(StructureKind structure, TraversalKind traversal) {
    if ((traversal == TraversalKind::Kd) != is_kd(structure)) {
        return traversal == TraversalKind::Kd
                   ? "the kd traversal needs a kd-tree; choose the structure kd-median or kd-sah"
                   : "a kd-tree needs the traversal kd";
    }
    if ((traversal == TraversalKind::Octree) != (structure == StructureKind::Octree)) {
        return traversal == TraversalKind::Octree ? "the octree traversal needs the structure octree"
                                                  : "an octree needs the traversal octree";
    }
    return std::nullopt;
}

std::optional<std::string> why_not(const Combination& c, bool on_cuda) {
    if (auto reason = why_not(c.structure, c.traversal)) return reason;
    if (!c.options.near_first && !has_order(c.traversal))
        return "this traversal has no order of children to switch off";
    if (!c.options.rta && c.traversal == TraversalKind::BruteForce)
        return "brute force has no nodes, and thus no redundant traversal to avoid";
    if (!c.options.rta_at_pops && c.traversal != TraversalKind::Compressed) {
        return "RTA at nodes only is for the compressed traversal; the stacks of others always hold distances";
    }
    if (c.options.tests == TestKind::Woop && c.traversal != TraversalKind::WhileWhile &&
        c.traversal != TraversalKind::Speculative) {
        return "Woop's triangle test works only with the traversals while-while and speculative";
    }
    if (c.traversal == TraversalKind::Wide8Simd && on_cuda)
        return "wide8-simd uses the CPU's vector unit; choose wide8 on a GPU";
    if (c.distribution != Distribution::OneAThread && !on_cuda) {
        return "a CPU's threads always take rays from a pool";
    }
    if (c.distribution == Distribution::DynamicFetch && c.traversal != TraversalKind::WhileWhile &&
        c.traversal != TraversalKind::Speculative && c.traversal != TraversalKind::Compressed) {
        return "fetching rays inside the traversal works only with while-while, speculative and compressed";
    }
    return std::nullopt;
}

} // namespace pertev
