#pragma once

// Downsamples a picture by means over square blocks of pixels, which reduces the noise of its samples by the block's
// side.

#include <cstdint>

#include "image/image.h"

namespace pertev {

/// One pixel per block of `side` x `side` pixels, side >= 1; blocks at the right and lower border average fewer
/// pixels. Sums are in double, row by row.
Image block_means(const Image& image, uint32_t side);

} // namespace pertev
