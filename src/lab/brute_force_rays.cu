#include "lab/brute_force_rays.h"

#include "device/launch_body.h"

namespace pertev {
template void launch(Queue&, const char*, WorkCount, const BruteForceRays&);
} // namespace pertev
