#pragma once

// A picture of means over square blocks of pixels: the noise of its samples is smaller by the block's side, what the
// blocks show stays.

#include <cstdint>

#include "image/image.h"

namespace pertev {

/// One pixel a block of `side` x `side` pixels, side >= 1; blocks that reach over the right and lower border are means
/// over the pixels there are. Sums are in double, row by row.
Image block_means(const Image& image, uint32_t side);

} // namespace pertev
