#pragma once

// The weight of a light path among all ways in which it could have been found: a walk from the camera and one from a
// light, joined anywhere. A weight needs the densities of all these ways; two numbers that a walk carries along hold
// what its own side has to say, so that no vertex is looked at twice.
//
// Source: Georgiev, "Implementing Vertex Connection and Merging", 2012, whose dVCM and dVC these are, without merging;
// the power heuristic (Veach 1997, section 9.2.4) with exponent 2, so all densities are squared. Delta scatterings
// count as if drawn with the same density from both sides, which any weights that add up to 1 may do.

#include "base/host_device.h"
#include "math/scalar.h"

namespace pertev {

/// Odds beyond this decide any weight: what is larger is this.
inline constexpr float kMostOdds = 0x1p+100f;

HD inline float squared_density(float density) { return square(min(density, 0x1p+30f)); }

struct MisWalk {
    // Squared densities over that of this walk as it is: of the way that ends one vertex earlier and reaches the last
    // one from the other side, but for the density of that step, which the other side knows;
    float last = 0;
    // and of all ways that end earlier still, but for the density of the step back from the last vertex.
    float earlier = 0;

    /// The walk reaches a surface under the cosine `cos_in` to its geometric normal, `distance_squared` away; that is 1
    /// where it comes from infinitely far.
    HD void arrive(float cos_in, float distance_squared) {
        const float inverse = 1.0f / max(square(cos_in), 0x1p-60f);
        last = min(last * min(square(distance_squared) * inverse, kMostOdds), kMostOdds);
        earlier = min(earlier * inverse, kMostOdds);
    }
    /// It goes on by the solid angle density `pdf` under `cos_out`; `reverse_pdf`: density of the way back.
    HD void scatter(float cos_out, float pdf, float reverse_pdf) {
        const float by = min(squared_density(cos_out) / square(pdf), kMostOdds);
        earlier = min(by * others(reverse_pdf), kMostOdds);
        last = min(1.0f / square(pdf), kMostOdds);
    }
    HD void scatter_by_delta(float cos_out) {
        earlier = earlier * square(cos_out);
        last = 0;
    }
    /// All ways that this walk knows, over the present one, but for the density of the step onto its last vertex.
    HD float others(float reverse_pdf) const { return min(last + earlier * squared_density(reverse_pdf), kMostOdds); }
};

/// The weight of one way, where the odds of all others add up to `others`; 0 where that is no number.
HD inline float mis_weight(float others) { return others < kInfinity ? 1.0f / (1.0f + others) : 0.0f; }

} // namespace pertev
