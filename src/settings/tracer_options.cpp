#include "settings/tracer_options.h"

#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"

namespace pertev {
namespace {

/// Calls set(combination, name) for each ray kind to which each of `values` applies; `set` returns false for an
/// unknown name.
template <class Set>
void apply(const std::string& setting, const std::vector<std::string>& values, TracerChoice& choice,
           const std::string& known, const Set& set) {
    for (const std::string& value : values) {
        const std::size_t equals = value.find('=');
        const std::string name = equals == std::string::npos ? value : value.substr(equals + 1);
        bool any = false, good = true;
        for (const RayKind kind : kValuesOf<RayKind>) {
            if (equals != std::string::npos && value.substr(0, equals) != name_of(kind)) continue;
            any = true;
            good = good && set(choice[kind], name);
        }
        if (any && good) continue;
        throw Error(
            ErrorCode::BadInput, setting, value,
            any ? "expected " + known
                : fmt::format("expected a kind of ray: camera, bounce or shadow, as in `{}=shadow={}`", setting, name));
    }
}

template <class Kind>
std::string list_of() {
    return fmt::format("one of {}", fmt::join(names_of<Kind>(), ", "));
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

bool set_on_off(bool& value, const std::string& name) {
    value = name == "on";
    return name == "on" || name == "off";
}

} // namespace

std::optional<TracerChoice> tracer_choice(const TracerOptions& options, bool on_cuda) {
    if (options.are_empty() && options.default_build == kDefaultBuild) return std::nullopt;
    TracerChoice choice =
        default_tracers(on_cuda, value_named<TreeBuild>(options.build).value_or(options.default_build));
    std::set<const Combination*> structure_named, traversal_named;
    apply("structure", options.structures, choice, list_of<StructureKind>(),
          [&](Combination& c, const std::string& name) {
              const auto kind = value_named<StructureKind>(name);
              if (kind) c.structure = *kind, structure_named.insert(&c);
              return kind.has_value();
          });
    apply("traversal", options.traversals, choice, list_of<TraversalKind>(),
          [&](Combination& c, const std::string& name) {
              const auto kind = value_named<TraversalKind>(name);
              // Switches and the distribution of the default traversal do not apply to this one.
              if (kind) c = {.structure = c.structure, .traversal = *kind}, traversal_named.insert(&c);
              return kind.has_value();
          });
    for (const RayKind kind : kValuesOf<RayKind>) {
        Combination& c = choice[kind];
        complete(c, structure_named.contains(&c), traversal_named.contains(&c));
    }
    apply("rta", options.rta, choice, "on, nodes or off", [](Combination& c, const std::string& name) {
        const auto switches = rta_named(name, c.options);
        if (switches) c.options = *switches;
        return switches.has_value();
    });
    apply("order", options.order, choice, "on or off",
          [](Combination& c, const std::string& name) { return set_on_off(c.options.near_first, name); });
    apply("distribution", options.distributions, choice, "one-a-thread, persistent or dynamic-fetch",
          [](Combination& c, const std::string& name) {
              const auto distribution = value_named<Distribution>(name);
              if (distribution) c.distribution = *distribution;
              return distribution.has_value();
          });
    check_choice(choice, on_cuda);
    return choice;
}

} // namespace pertev
