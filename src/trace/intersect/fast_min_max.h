#pragma once

// Minimum and maximum of floats by one instruction on the device, where math/scalar.h's take two. Of equal zeros either
// comes out, and where one is NaN the other may: who calls them gets along with that.

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
