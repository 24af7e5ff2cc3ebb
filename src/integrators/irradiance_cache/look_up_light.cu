#include "device/launch_body.h"
#include "integrators/irradiance_cache/lookup_stages.h"

namespace pertev {
template void launch(Queue&, const char*, WorkCount, const LookUpLight<MaterialsKnown::Nothing>&);
template void launch(Queue&, const char*, WorkCount, const LookUpLight<MaterialsKnown::PlainDiffuse>&);
} // namespace pertev
