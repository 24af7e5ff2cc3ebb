#include "settings/tracer_options.h"

#include <set>

namespace pertev {
namespace {

/// Calls set(combination, name) for each ray kind to which each of `values` applies.
template <class Set>
void apply(const std::vector<std::string>& values, TracerChoice& choice, const Set& set) {
    for (const std::string& value : values) {
        const std::size_t equals = value.find('=');
        for (const RayKind kind : kValuesOf<RayKind>) {
            if (equals == std::string::npos) {
                set(choice[kind], value);
            } else if (value.substr(0, equals) == name_of(kind)) {
                set(choice[kind], value.substr(equals + 1));
            }
        }
    }
}

/// Completes a combination: a structure with only one traversal implies that traversal, without the switches of the
/// default traversal, and vice versa.
void complete(Combination& c, bool structure_named, bool traversal_named) {
    if (structure_named && !traversal_named) {
        if (const auto traversal = only_traversal_of(c.structure))
            c = {.structure = c.structure, .traversal = *traversal};
    }
    if (traversal_named && !structure_named) {
        if (c.traversal == TraversalKind::Kd) c.structure = StructureKind::KdSah;
        if (c.traversal == TraversalKind::Octree) c.structure = StructureKind::Octree;
    }
}

} // namespace

std::optional<TracerChoice> tracer_choice(const TracerOptions& options, bool on_cuda) {
    if (options.are_empty() && options.default_build == kDefaultBuild) return std::nullopt;
    TracerChoice choice =
        default_tracers(on_cuda, value_named<TreeBuild>(options.build).value_or(options.default_build));
    std::set<const Combination*> structure_named, traversal_named;
    apply(options.structures, choice, [&](Combination& c, const std::string& name) {
        c.structure = value_named<StructureKind>(name).value();
        structure_named.insert(&c);
    });
    apply(options.traversals, choice, [&](Combination& c, const std::string& name) {
        // Switches and the distribution of the default traversal do not apply to this one.
        c = {.structure = c.structure, .traversal = value_named<TraversalKind>(name).value()};
        traversal_named.insert(&c);
    });
    for (const RayKind kind : kValuesOf<RayKind>) {
        Combination& c = choice[kind];
        complete(c, structure_named.contains(&c), traversal_named.contains(&c));
    }
    apply(options.rta, choice,
          [](Combination& c, const std::string& name) { c.options = rta_named(name, c.options).value(); });
    apply(options.order, choice, [](Combination& c, const std::string& name) { c.options.near_first = name == "on"; });
    apply(options.distributions, choice,
          [](Combination& c, const std::string& name) { c.distribution = value_named<Distribution>(name).value(); });
    check_choice(choice, on_cuda);
    return choice;
}

} // namespace pertev
