#pragma once

// The size of a picture that fills a window.

#include <cstdint>

#include "settings/picture_options.h"

namespace pertev {

/// Returns a size with the window's shape and even sides (JPEG halves the resolution of colour). It has at most
/// `max_pixels` pixels, and at most those of the window. For a window more than 4 times as long as wide the ratio is
/// 4 to 1.
PictureSize size_for_window(uint32_t width, uint32_t height, uint64_t max_pixels);

} // namespace pertev
