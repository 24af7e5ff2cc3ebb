#include "device/launch_body.h"
#include "integrators/photon_map/gather_stages.h"
#include "integrators/photon_map/order_photons.h"
#include "integrators/photon_map/photon_stages.h"
#include "integrators/photon_map/photon_targets.h"

namespace pertev {
template void launch(Queue&, const char*, WorkCount, const FindSpecular&);
template void launch(Queue&, const char*, WorkCount, const BeginPhotons&);
template void launch(Queue&, const char*, WorkCount, const NumberPhotons&);
template void launch(Queue&, const char*, WorkCount, const OrderPhotons&);
template void launch(Queue&, const char*, WorkCount, const MakeBuckets&);
template void launch(Queue&, const char*, WorkCount, const FindBuckets&);
template void launch(Queue&, const char*, WorkCount, const KeepPhotons&);
template void launch(Queue&, const char*, WorkCount, const BeginSights&);
template void launch(Queue&, const char*, WorkCount, const ShadePhotons<MaterialsKnown::Nothing>&);
template void launch(Queue&, const char*, WorkCount, const ShadePhotons<MaterialsKnown::PlainDiffuse>&);
template void launch(Queue&, const char*, WorkCount, const ShadeSights<MaterialsKnown::Nothing>&);
template void launch(Queue&, const char*, WorkCount, const ShadeSights<MaterialsKnown::PlainDiffuse>&);
} // namespace pertev
