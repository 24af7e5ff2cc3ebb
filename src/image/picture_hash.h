#pragma once

// The hash of a picture in the one-picture law, printed at the end of a render and by `pertev info`.

#include <span>

#include "base/hash.h"
#include "image/image.h"

namespace pertev {

/// Hash of width, height (uint32), then the bits of R, G, B, and A if there is one, row by row from the top. Grey
/// counts as R = G = B. A picture has the same hash after it was written as EXR and read again.
Hash128 picture_hash(const Image& picture);
/// Returns the hash of a picture of 3 or 4 channels with these `pixels`.
Hash128 picture_hash(uint32_t width, uint32_t height, std::span<const float> pixels);

} // namespace pertev
