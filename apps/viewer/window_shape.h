#pragma once

// The size of a picture that fills a window: pure arithmetic.

#include <cstdint>

#include "settings/picture_options.h"

namespace pertev {

/// Returns a size of the window's shape, with even sides (JPEG halves the resolution of colour). It has at most
/// `most_pixels` pixels, and no more than the window, which shows no more. A window that is more than 4 times as long
/// as it is wide gets a picture of 4 to 1.
PictureSize size_for_window(uint32_t width, uint32_t height, uint64_t most_pixels);

} // namespace pertev
