#pragma once

// a b - c d without cancellation: at most 1.5 ulp off, so its sign is exact where nothing underflows.
//
// Source: Kahan; Jeannerod, Louvet, Muller, "Further analysis of Kahan's algorithm for the accurate computation of
// 2x2 determinants", Mathematics of Computation 82, 2013.

#include "base/host_device.h"
#include "math/scalar.h"

namespace pertev {

/// a b - c d; products within [2^-100, 2^127] or 0, else the sign may be lost.
HD inline float difference_of_products(float a, float b, float c, float d) {
    const float cd = c * d;
    const float error = fma(-c, d, cd);
    return fma(a, b, -cd) + error;
}

/// a b - c d for any floats: the products are exact in double, so the sign is that of the exact value (or 0).
HD inline float difference_of_products_in_double(float a, float b, float c, float d) {
    return static_cast<float>(static_cast<double>(a) * static_cast<double>(b) -
                              static_cast<double>(c) * static_cast<double>(d));
}

} // namespace pertev
