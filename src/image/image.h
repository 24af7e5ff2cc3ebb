#pragma once

// Pictures in memory. Row 0 is the top row; pixels of a row left to right; channels interleaved.

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pertev {

/// Float picture; colours are linear Rec. 709 unless stated otherwise.
struct Image {
    uint32_t width = 0, height = 0;
    uint32_t channels = 3;     // 1 to 4: Y, (Y, A), RGB, RGBA
    std::vector<float> pixels; // [height * width * channels]

    const float* at(uint32_t x, uint32_t y) const { return pixels.data() + (std::size_t(y) * width + x) * channels; }
    float* at(uint32_t x, uint32_t y) { return pixels.data() + (std::size_t(y) * width + x) * channels; }
};

/// 8-bit RGBA picture as in a file: colour channels still encoded (sRGB, or data such as normals), alpha linear.
struct Rgba8Image {
    uint32_t width = 0, height = 0;
    std::vector<uint8_t> pixels; // [height * width * 4]
};

} // namespace pertev
