#pragma once

// The limit of `integrator=bidirectional` that others ask for, apart from its stages.

#include <cstdint>

namespace pertev {

/// The largest max_depth: vertices of the walks from the lights are kept, 48 bytes each.
inline constexpr uint32_t kMostJoinedDepth = 255;

} // namespace pertev
