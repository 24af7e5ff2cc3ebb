#pragma once

// Chooses between two kernels: for scenes whose materials have coats, fuzz, thin walls or weighted reflections, and,
// with half as many registers, for all others.

#include "shading/shading_variant.h"

namespace pertev {

/// Calls run.operator()<kVariant>() with General if the scene's variant is that, else with Unstacked.
template <class Run>
void with_stacks(ShadingVariant variant, const Run& run) {
    if (variant == ShadingVariant::General) return run.template operator()<ShadingVariant::General>();
    run.template operator()<ShadingVariant::Unstacked>();
}

} // namespace pertev
