#pragma once

// The value that stands for no node. It is separate from scene/node.h, which device code need not include.

#include <cstdint>

namespace pertev {

inline constexpr uint32_t kNoNode = 0xffffffffu;

} // namespace pertev
