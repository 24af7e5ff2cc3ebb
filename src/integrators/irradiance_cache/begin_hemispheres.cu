#include "device/launch_body.h"
#include "integrators/irradiance_cache/hemisphere_stages.h"

namespace pertev {
template void launch(Queue&, const char*, WorkCount, const BeginHemispheres<MaterialsKnown::Nothing>&);
template void launch(Queue&, const char*, WorkCount, const BeginHemispheres<MaterialsKnown::PlainDiffuse>&);
} // namespace pertev
