#include "device/launch_body.h"
#include "integrators/irradiance_cache/hemisphere_stages.h"

namespace pertev {
template void launch(Queue&, const char*, WorkCount, const BeginHemispheres<ShadingVariant::General>&);
template void launch(Queue&, const char*, WorkCount, const BeginHemispheres<ShadingVariant::PlainDiffuse>&);
template void launch(Queue&, const char*, WorkCount, const FinishRecords<ShadingVariant::General>&);
template void launch(Queue&, const char*, WorkCount, const FinishRecords<ShadingVariant::PlainDiffuse>&);
} // namespace pertev
