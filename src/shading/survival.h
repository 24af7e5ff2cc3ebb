#pragma once

// Russian roulette of paths between perfect interfaces.

#include <cstdint>

#include "base/host_device.h"
#include "math/scalar.h"

namespace pertev {

/// Returns the survival probability of Russian roulette after a delta lobe was sampled, where a rule gives
/// `probability`: beyond 64 `scatterings` by delta lobes (or by any, where those are not counted) at most 0.98. Total
/// internal reflection may hold light forever without loss, and the last such paths of a picture would hold up a GPU.
/// Paths that other lobes scatter keep their probability, because with a lower one the variance of many scatterings of
/// little loss has no bound.
HD inline float survival_after_delta(uint32_t scatterings, float probability) {
    return scatterings > 64 ? min(probability, 0.98f) : probability;
}

} // namespace pertev
