#pragma once

// Assumptions about BSDFs for device code, without which a kernel contains the code of lobes that its scenes lack.

#include "base/host_device.h"
#include "shading/bsdf.h"
#include "shading/shading_variant.h"

namespace pertev {

/// Tells the compiler what all BSDFs of a scene's variant have in common, which it cannot see in memory.
template <ShadingVariant kVariant>
HD inline void assume_variant([[maybe_unused]] const Bsdf& bsdf) {
#if defined(__CUDA_ARCH__)
    if constexpr (has_lobes(kVariant)) {
        __builtin_assume(bsdf.is_called == (kVariant == ShadingVariant::General));
    } else {
        __builtin_assume(bsdf.base.kind == LobeKind::Diffuse);
        __builtin_assume(bsdf.layer_count == 0);
        __builtin_assume(!bsdf.is_called);
    }
#endif
}

} // namespace pertev
