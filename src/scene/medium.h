#pragma once

// A homogeneous participating medium: it absorbs and scatters light equally everywhere in the space that it fills.
//
// Source: Pharr, Jakob, Humphreys, "Physically Based Rendering", 4th ed., sections 11.1 and 11.3.1.

#include "base/host_device.h"
#include "math/rgb.h"

namespace pertev {

inline constexpr float kMaxScatterAnisotropy = 0.999f; // limit of |g|; at 1 light would go straight on

struct MediumParameters {
    Rgb sigma_a = {0, 0, 0}; // absorption, 1/m, >= 0
    Rgb sigma_s = {0, 0, 0}; // scattering, 1/m, >= 0
    float g = 0; // mean cosine of the angle of scattering (Henyey-Greenstein): 0 isotropic, above 0 forwards

    /// Returns the extinction, 1/m.
    HD Rgb sigma_t() const { return sigma_a + sigma_s; }
    HD bool scatters() const { return max_component(sigma_s) > 0; }
    /// Returns whether the medium differs from a vacuum.
    HD bool is_there() const { return scatters() || max_component(sigma_a) > 0; }
    bool operator==(const MediumParameters&) const = default;
};

} // namespace pertev
