#pragma once

// When a picture that gathers samples is shown in place of a reconstruction: once its own error, as it is estimated, is
// the smaller one.
//
// Neither is known, but their sum is. Let the picture be the mean of two halves of its samples, which err
// independently: then the mean square of what lies between it and its first half is the square of its own error; and
// what lies between it and the reconstruction has both errors in it.

#include "image/image.h"

namespace pertev {

/// All three are shown alike, `whole` and `half` have one size. `reconstruction` is looked at as a page stretches it to
/// that size.
bool reference_is_better(const Rgba8Image& whole, const Rgba8Image& half, const Rgba8Image& reconstruction);

} // namespace pertev
