#pragma once

// Chooses a kernel by what a scene's materials have. One for stacked materials (MaterialParameters::is_stacked) needs
// twice as many registers as one without them.

#include "shading/shading_variant.h"

namespace pertev {

/// Calls run.operator()<kVariant>() with General if the scene's variant is that, else with Unstacked.
template <class Run>
void with_stacks(ShadingVariant variant, const Run& run) {
    switch (variant) {
    case ShadingVariant::General:
        return run.template operator()<ShadingVariant::General>();
    case ShadingVariant::Unstacked:
    case ShadingVariant::Diffuse:
    case ShadingVariant::PlainDiffuse:
        return run.template operator()<ShadingVariant::Unstacked>();
    }
}

/// Calls run.operator()<kVariant>() with General, Unstacked, or Diffuse if all materials are diffuse.
template <class Run>
void with_textures(ShadingVariant variant, const Run& run) {
    switch (variant) {
    case ShadingVariant::General:
        return run.template operator()<ShadingVariant::General>();
    case ShadingVariant::Unstacked:
        return run.template operator()<ShadingVariant::Unstacked>();
    case ShadingVariant::Diffuse:
    case ShadingVariant::PlainDiffuse:
        return run.template operator()<ShadingVariant::Diffuse>();
    }
}

/// Calls run.operator()<kVariant>() with General, Unstacked, or PlainDiffuse where the variant is exactly that.
template <class Run>
void with_plain_diffuse(ShadingVariant variant, const Run& run) {
    switch (variant) {
    case ShadingVariant::General:
        return run.template operator()<ShadingVariant::General>();
    case ShadingVariant::Unstacked:
    case ShadingVariant::Diffuse:
        return run.template operator()<ShadingVariant::Unstacked>();
    case ShadingVariant::PlainDiffuse:
        return run.template operator()<ShadingVariant::PlainDiffuse>();
    }
}

} // namespace pertev
