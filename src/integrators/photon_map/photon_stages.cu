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
template void launch(Queue&, const char*, WorkCount, const BeginGather&);
template void launch(Queue&, const char*, WorkCount, const ShadePhotons<ShadingVariant::General>&);
template void launch(Queue&, const char*, WorkCount, const ShadePhotons<ShadingVariant::PlainDiffuse>&);
template void launch(Queue&, const char*, WorkCount, const ShadeGather<ShadingVariant::General>&);
template void launch(Queue&, const char*, WorkCount, const ShadeGather<ShadingVariant::PlainDiffuse>&);
} // namespace pertev
