#pragma once

// Decides when an accumulating picture replaces a reconstruction: once its estimated error is the smaller one.
//
// Neither error is known, but two differences are. If the picture is the mean of two halves of its samples, whose
// errors are independent, the mean square of the difference between it and its first half is the square of its own
// error; and the difference between it and the reconstruction contains both errors.

#include "image/image.h"

namespace pertev {

/// Returns whether the picture `whole` is nearer to the converged picture than `reconstruction`. All three have the
/// same display; `whole` and `half` have the same size. `reconstruction` is stretched to that size as on a page.
bool reference_is_better(const Rgba8Image& whole, const Rgba8Image& half, const Rgba8Image& reconstruction);

} // namespace pertev
