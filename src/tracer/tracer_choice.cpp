#include "tracer/tracer_choice.h"

#include <fmt/format.h>

#include "base/error.h"
#include "tracer/traversal_kernels.h"

namespace pertev {

TracerChoice same_for_all(const Combination& combination) { return {combination, combination, combination}; }

StructureKind structure_of(TreeBuild build) {
    switch (build) {
    case TreeBuild::Fast:
        return StructureKind::Binned;
    case TreeBuild::Balanced:
        return StructureKind::SpatialSplits;
    case TreeBuild::Best:
        break;
    }
    return StructureKind::SpatialReinsertion;
}

TracerChoice default_tracers(bool on_cuda, TreeBuild build) {
    const StructureKind structure = structure_of(build);
    if (on_cuda) { // camera rays are coherent: packets over binary nodes; other rays: single rays over compressed
                   // nodes
        const Combination together = {.structure = structure, .traversal = TraversalKind::Octants};
        const Combination alone = {.structure = structure,
                                   .traversal = TraversalKind::Compressed,
                                   .options = {.rta_at_pops = false},
                                   .distribution = Distribution::DynamicFetch};
        return {together, alone, alone};
    }
    TracerChoice choice = same_for_all({.structure = structure, .traversal = TraversalKind::Wide8Simd});
    // Any-hit searches end sooner if they visit the first child first (for rays without an end: trace/trace_any.h).
    choice.shadow.options.near_first = false;
    return choice;
}

BvhBuilder builder_of(const TracerChoice& choice) {
    for (const RayKind kind : {RayKind::Bounce, RayKind::Shadow, RayKind::Camera}) {
        if (const auto builder = builder_of(choice[kind].structure)) return *builder;
    }
    return *builder_of(structure_of(kDefaultBuild));
}

bool can_traverse_on_host(const TracerChoice& choice, bool on_cuda) {
    if (on_cuda) return false;
    for (const RayKind kind : kValuesOf<RayKind>) {
        Combination c = choice[kind];
        if (kind == RayKind::Shadow) c.options.near_first = true; // the order does not change the result
        if (!(c == Combination{.structure = choice.camera.structure, .traversal = TraversalKind::Wide8Simd}))
            return false;
    }
    return true;
}

void check_choice(const TracerChoice& choice, bool on_cuda) {
    for (const RayKind kind : kValuesOf<RayKind>) {
        const Combination& c = choice[kind];
        if (const auto reason = why_no_tracer(c, on_cuda)) {
            throw Error(ErrorCode::BadInput, "traversal", std::string(name_of(c.traversal)),
                        fmt::format("{}: {}", name_of(c), *reason));
        }
        if (!c.options.is_exact()) {
            throw Error(ErrorCode::BadInput, "traversal", std::string(name_of(c.traversal)),
                        fmt::format("{}: {} tests miss hits at edges; renders use exact tests", name_of(c),
                                    name_of(c.options.tests)));
        }
    }
}

} // namespace pertev
