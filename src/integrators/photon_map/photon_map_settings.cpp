#include "integrators/photon_map/photon_map_settings.h"

#include "math/scalar.h"

namespace pertev {

float radius_of_pass(uint32_t pass) {
    constexpr double kAlpha = 2.0 / 3.0;
    double squared = 1; // a product of doubles in a fixed order: the same everywhere
    for (uint32_t i = 1; i <= pass; ++i) squared *= (i + kAlpha) / (i + 1.0);
    return sqrt(static_cast<float>(squared));
}

} // namespace pertev
