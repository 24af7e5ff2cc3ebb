#pragma once

// How large a picture will be in memory, off its file's header alone: to be known before the pixels are decoded.

#include <cstdint>

namespace pertev {

struct ImageHeader {
    uint32_t width = 0, height = 0;
    bool is_float = false; // decode_image gives an Image; else an Rgba8Image
};

} // namespace pertev
