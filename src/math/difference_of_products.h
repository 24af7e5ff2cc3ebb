#pragma once

// Computes a b - c d without the cancellation of the naive form: at most 1.5 ulp off unless a product underflows, and
// with the exact sign. Edge functions and determinants of 2x2 matrices use it.
//
// Source: Kahan's algorithm; bound by Jeannerod, Louvet, Muller, "Further analysis of Kahan's algorithm for the
// accurate computation of 2x2 determinants", Mathematics of Computation 82, 2013.

#include "base/host_device.h"
#include "math/scalar.h"

namespace pertev {

/// Returns a b - c d. Swapping (a, b) with (c, d) may change the last bit, but not the sign.
HD inline float difference_of_products(float a, float b, float c, float d) {
    const float cd = c * d;
    const float error = fma(-c, d, cd);
    return fma(a, b, -cd) + error;
}

/// Returns a b - c d as a double: both products are exact in it, whatever underflows in float, so the sign is right;
/// rounded once. Swapping (a, b) with (c, d) changes only the sign.
HD inline double difference_of_products_in_double(float a, float b, float c, float d) {
    return static_cast<double>(a) * static_cast<double>(b) - static_cast<double>(c) * static_cast<double>(d);
}

} // namespace pertev
