#pragma once

// Whether two pictures differ by more than their noise, from the variances of their pixels' means.

#include "image/image.h"

namespace pertev {

/// Returns the p-value of each pixel and R, G, B: the probability of a difference at least as large as that of `a` and
/// `b` if both have the same expectation, whose estimates are normal with the variances `variance_a` and `variance_b`.
/// Where both variances are 0, it is 1 if the values agree within 1e-4 of the larger one, else 0. A value that is not
/// finite has 0. The pictures have 3 or 4 channels (alpha is not compared), the variances 3, and all the same size.
Image p_values(const Image& a, const Image& variance_a, const Image& b, const Image& variance_b);

struct Significance {
    double p = 1;           // the probability of a least p-value as small as this one among
                            // so many (Sidak)
    double share_below = 0; // the share of p-values below 0.01, which is 0.01 for
                            // pictures of equal expectation
};
/// Sums up p-values. Source: Sidak, "Rectangular confidence regions for the means of multivariate normal
/// distributions", JASA 62, 1967.
Significance significance_of(const Image& p);

} // namespace pertev
