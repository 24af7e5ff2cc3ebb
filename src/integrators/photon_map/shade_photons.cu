#include "device/launch_body.h"
#include "integrators/photon_map/photon_stages.h"

namespace pertev {
template void launch(Queue&, const char*, WorkCount, const ShadePhotons<MaterialsKnown::Nothing>&);
template void launch(Queue&, const char*, WorkCount, const ShadePhotons<MaterialsKnown::PlainDiffuse>&);
} // namespace pertev
