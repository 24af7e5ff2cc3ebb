#include "device/launch_body.h"
#include "integrators/irradiance_cache/lookup_stages.h"

namespace pertev {
template void launch(Queue&, const char*, WorkCount, const LookUpRadiance<ShadingVariant::General>&);
template void launch(Queue&, const char*, WorkCount, const LookUpRadiance<ShadingVariant::PlainDiffuse>&);
template void launch(Queue&, const char*, WorkCount, const FindRecordSites<ShadingVariant::General>&);
template void launch(Queue&, const char*, WorkCount, const FindRecordSites<ShadingVariant::PlainDiffuse>&);
template void launch(Queue&, const char*, WorkCount, const DrawRecords<ShadingVariant::General>&);
template void launch(Queue&, const char*, WorkCount, const DrawRecords<ShadingVariant::PlainDiffuse>&);
} // namespace pertev
