#pragma once

// Weighted reservoir sampling with a reservoir of one (Chao 1982): selects one of a stream of items with probability
// proportional to its weight, by a single random number.
//
// A reservoir's item represents an integral by resampled importance sampling, RIS (Talbot et al., "Importance
// Resampling for Global Illumination", EGSR 2005): if weights are m(x) target(x) / density(x) and the m of all
// techniques that could have drawn x add up to 1, sum / target(selected) is an unbiased weight of the selected item
// (Bitterli et al., "Spatiotemporal Reservoir Resampling for Real-Time Ray Tracing with Dynamic Direct Lighting",
// SIGGRAPH 2020).

#include "base/host_device.h"
#include "math/scalar.h"

namespace pertev {

struct RisSelection {
    float u;       // uniform in (0, 1)
    float sum = 0; // sum of weights so far

    /// Returns whether the next item, of `weight`, replaces the selected one. An item with a weight of 0 or not finite
    /// is never selected.
    HD bool takes(float weight) {
        if (!(weight > 0) || !is_finite(weight)) return false;
        sum += weight;
        const float share = weight / sum;
        const bool is_taken = u < share;
        // After rescaling, u is uniform again.
        u = is_taken ? u / share : (u - share) / (1.0f - share);
        u = clamp(u, 0x1p-24f, 0x1.fffffep-1f);
        return is_taken;
    }
};

} // namespace pertev
