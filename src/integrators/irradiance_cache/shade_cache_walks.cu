#include "device/launch_body.h"
#include "integrators/irradiance_cache/cache_stages.h"

namespace pertev {
template void launch(Queue&, const char*, WorkCount, const ShadeCacheWalks<MaterialsKnown::Nothing>&);
template void launch(Queue&, const char*, WorkCount, const ShadeCacheWalks<MaterialsKnown::PlainDiffuse>&);
} // namespace pertev
