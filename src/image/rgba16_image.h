#pragma once

// 16-bit RGBA pictures, encoded as 8-bit ones (image/image.h).

#include <cstdint>
#include <vector>

namespace pertev {

struct Rgba16Image {
    uint32_t width = 0, height = 0;
    std::vector<uint16_t> pixels; // [height * width * 4]
};

} // namespace pertev
