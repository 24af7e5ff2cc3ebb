#include "render/fixed_sum.h"

#include <cmath>

namespace pertev {

float mean_of(FixedSum sum, uint64_t count) {
    __extension__ using Wide = unsigned __int128;
    const bool negative = (sum.high >> 63) != 0;
    Wide magnitude = (Wide(sum.high) << 64) | sum.low;
    if (negative) magnitude = -magnitude;
    if (magnitude == 0) return 0;

    // Long division that keeps 26 or more significant bits of the quotient and whether anything is left: enough for one
    // correct rounding. `exponent` counts the powers of two brought in from below the point.
    Wide quotient = magnitude / count;
    Wide rest = magnitude % count;
    int exponent = -64;
    while (quotient < (Wide(1) << 26)) {
        rest <<= 1;
        quotient = (quotient << 1) | (rest >= count ? 1 : 0);
        if (rest >= count) rest -= count;
        --exponent;
    }
    bool sticky = rest != 0;
    while (quotient >= (Wide(1) << 26)) { // down to 26 bits: 24 of the float, one to round by, one for the rest
        sticky = sticky || (quotient & 1) != 0;
        quotient >>= 1;
        ++exponent;
    }
    // An odd last bit below the rounding bit stands for everything cut; the double is exact, its conversion rounds
    // once. Sums are multiples of 2^-64 / count > 2^-128, of which only those below 2^-126 meet subnormal floats: ldexp
    // first.
    const double exact = static_cast<double>(static_cast<uint64_t>((quotient << 1) | (sticky ? 1 : 0)));
    const float mean = static_cast<float>(std::ldexp(exact, exponent - 1));
    return negative ? -mean : mean;
}

} // namespace pertev
