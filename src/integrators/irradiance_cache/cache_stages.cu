#include "device/launch_body.h"
#include "integrators/irradiance_cache/cache_stages.h"
#include "integrators/irradiance_cache/hemisphere_stages.h"
#include "integrators/irradiance_cache/lookup_stages.h"
#include "integrators/irradiance_cache/overture_grid.h"

namespace pertev {
template void launch(Queue&, const char*, WorkCount, const BeginCacheSubpaths&);
template void launch(Queue&, const char*, WorkCount, const CountMirroredEmitters&);
template void launch(Queue&, const char*, WorkCount, const BeginSeekers&);
template void launch(Queue&, const char*, WorkCount, const StoreDistances&);
template void launch(Queue&, const char*, WorkCount, const ReadCells&);
template void launch(Queue&, const char*, WorkCount, const ShadeCacheSubpaths<ShadingVariant::General>&);
template void launch(Queue&, const char*, WorkCount, const ShadeCacheSubpaths<ShadingVariant::PlainDiffuse>&);
template void launch(Queue&, const char*, WorkCount, const BeginHemispheres<ShadingVariant::General>&);
template void launch(Queue&, const char*, WorkCount, const BeginHemispheres<ShadingVariant::PlainDiffuse>&);
template void launch(Queue&, const char*, WorkCount, const FinishRecords<ShadingVariant::General>&);
template void launch(Queue&, const char*, WorkCount, const FinishRecords<ShadingVariant::PlainDiffuse>&);
template void launch(Queue&, const char*, WorkCount, const LookUpRadiance<ShadingVariant::General>&);
template void launch(Queue&, const char*, WorkCount, const LookUpRadiance<ShadingVariant::PlainDiffuse>&);
template void launch(Queue&, const char*, WorkCount, const FindRecordSites<ShadingVariant::General>&);
template void launch(Queue&, const char*, WorkCount, const FindRecordSites<ShadingVariant::PlainDiffuse>&);
template void launch(Queue&, const char*, WorkCount, const DrawRecords<ShadingVariant::General>&);
template void launch(Queue&, const char*, WorkCount, const DrawRecords<ShadingVariant::PlainDiffuse>&);
} // namespace pertev
