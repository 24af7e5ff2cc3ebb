#pragma once

// What says that something stands in no node. Apart from scene/node.h, which device code need not read.

#include <cstdint>

namespace pertev {

inline constexpr uint32_t kNoNode = 0xffffffffu;

} // namespace pertev
