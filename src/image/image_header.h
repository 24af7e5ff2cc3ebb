#pragma once

// The size of a picture in memory according to its file's header, known before the pixels are decoded.

#include <cstdint>

namespace pertev {

struct ImageHeader {
    uint32_t width = 0, height = 0;
    bool is_float = false; // decode_image returns an Image; else an Rgba8Image
};

} // namespace pertev
