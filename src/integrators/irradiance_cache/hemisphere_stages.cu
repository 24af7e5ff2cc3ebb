#include "device/launch_body.h"
#include "integrators/irradiance_cache/hemisphere_stages.h"

namespace pertev {
template void launch(Queue&, const char*, WorkCount, const BeginHemispheres<MaterialsKnown::Nothing>&);
template void launch(Queue&, const char*, WorkCount, const BeginHemispheres<MaterialsKnown::PlainDiffuse>&);
template void launch(Queue&, const char*, WorkCount, const FinishRecords<MaterialsKnown::Nothing>&);
template void launch(Queue&, const char*, WorkCount, const FinishRecords<MaterialsKnown::PlainDiffuse>&);
} // namespace pertev
