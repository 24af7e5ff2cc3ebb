#pragma once

// Chooses a kernel by what a scene's materials have. One for coats, fuzz, thin walls and weighted reflections needs
// twice as many registers as one without them.

#include "shading/shading_variant.h"

namespace pertev {

/// Calls run.operator()<kVariant>() with General if the scene's variant is that, else with Unstacked.
template <class Run>
void with_stacks(ShadingVariant variant, const Run& run) {
    if (variant == ShadingVariant::General) return run.template operator()<ShadingVariant::General>();
    run.template operator()<ShadingVariant::Unstacked>();
}

/// Calls run.operator()<kVariant>() with General, Unstacked, or Diffuse if all materials are diffuse.
template <class Run>
void with_textures(ShadingVariant variant, const Run& run) {
    if (has_lobes(variant)) return with_stacks(variant, run);
    run.template operator()<ShadingVariant::Diffuse>();
}

} // namespace pertev
