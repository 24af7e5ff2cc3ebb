#include "lab/brute_force_rays.h"

#include "device/launch_body.h"

namespace pertev {
template void launch(Queue&, const char*, uint32_t, const BruteForceRays&);
} // namespace pertev
