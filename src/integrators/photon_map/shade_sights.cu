#include "device/launch_body.h"
#include "integrators/photon_map/gather_stages.h"

namespace pertev {
template void launch(Queue&, const char*, WorkCount, const ShadeSights<MaterialsKnown::Nothing>&);
template void launch(Queue&, const char*, WorkCount, const ShadeSights<MaterialsKnown::PlainDiffuse>&);
} // namespace pertev
