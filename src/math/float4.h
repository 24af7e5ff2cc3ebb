#pragma once

// Sixteen bytes that device code loads and stores in one instruction.

#include <cstdint>

namespace pertev {

struct alignas(16) Float4 {
    float x, y, z, w;
};

struct alignas(8) Uint2 {
    uint32_t x, y;
};

struct alignas(16) Uint4 {
    uint32_t x, y, z, w;
};

} // namespace pertev
