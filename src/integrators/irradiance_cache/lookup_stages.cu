#include "device/launch_body.h"
#include "integrators/irradiance_cache/lookup_stages.h"

namespace pertev {
template void launch(Queue&, const char*, WorkCount, const LookUpLight<MaterialsKnown::Nothing>&);
template void launch(Queue&, const char*, WorkCount, const LookUpLight<MaterialsKnown::PlainDiffuse>&);
template void launch(Queue&, const char*, WorkCount, const SeekPlaces<MaterialsKnown::Nothing>&);
template void launch(Queue&, const char*, WorkCount, const SeekPlaces<MaterialsKnown::PlainDiffuse>&);
template void launch(Queue&, const char*, WorkCount, const DrawRecords<MaterialsKnown::Nothing>&);
template void launch(Queue&, const char*, WorkCount, const DrawRecords<MaterialsKnown::PlainDiffuse>&);
} // namespace pertev
