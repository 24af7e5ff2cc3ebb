#pragma once

// One of a stream of items, each with the probability of its weight over the sum of all: weighted reservoir sampling
// with a reservoir of one (Chao 1982), by a single random number.
//
// A reservoir's item stands for an integral by resampled importance sampling (Talbot et al., "Importance Resampling for
// Global Illumination", EGSR 2005): where weights are m(x) target(x) / density(x) and the m of all that could have
// drawn x add up to 1, sum / target(picked) is an unbiased weight of the picked item (Bitterli et al., "Spatiotemporal
// Reservoir Resampling for Real-Time Ray Tracing with Dynamic Direct Lighting", SIGGRAPH 2020).

#include "base/host_device.h"
#include "math/scalar.h"

namespace pertev {

struct WeightedPick {
    float u;       // uniform in (0, 1)
    float sum = 0; // of weights so far

    /// Whether the next item, of `weight`, is picked in place of the one before. An item of no weight, or of one that
    /// is not finite, never is.
    HD bool takes(float weight) {
        if (!(weight > 0) || !is_finite(weight)) return false;
        sum += weight;
        const float share = weight / sum;
        const bool is_taken = u < share;
        // What is left of u is uniform again.
        u = is_taken ? u / share : (u - share) / (1.0f - share);
        u = clamp(u, 0x1p-24f, 0x1.fffffep-1f);
        return is_taken;
    }
};

} // namespace pertev
