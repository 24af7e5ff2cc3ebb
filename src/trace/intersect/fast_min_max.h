#pragma once

// Minimum and maximum of floats in one device instruction, where math/scalar.h's take two. The result for two equal
// zeros may be either, and so may that for a NaN; callers must accept both.

#include "base/host_device.h"

namespace pertev {

#if PERTEV_ON_DEVICE
HD inline float fast_min(float a, float b) { return ::fminf(a, b); }
HD inline float fast_max(float a, float b) { return ::fmaxf(a, b); }
#else
HD inline float fast_min(float a, float b) { return a < b ? a : b; }
HD inline float fast_max(float a, float b) { return a > b ? a : b; }
#endif

} // namespace pertev
