#pragma once

// Linear values of the 256 sRGB-encoded bytes.

#include <array>

namespace pertev {

/// Entry i is srgb_decode(i / 255).
const std::array<float, 256>& srgb_decode_table();

} // namespace pertev
