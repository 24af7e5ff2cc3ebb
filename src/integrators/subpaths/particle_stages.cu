#include "device/launch_body.h"
#include "integrators/subpaths/particle_stages.h"

namespace pertev {
template void launch(Queue&, const char*, WorkCount, const BeginParticles&);
template void launch(Queue&, const char*, WorkCount, const BeginEyes&);
template void launch(Queue&, const char*, WorkCount, const AddSplats&);
template void launch(Queue&, const char*, WorkCount, const AddConnections&);
template void launch(Queue&, const char*, WorkCount, const CountWalks&);
template void launch(Queue&, const char*, WorkCount, const BeginWalks&);
template void launch(Queue&, const char*, WorkCount, const ShadeParticles<MaterialsKnown::Nothing>&);
template void launch(Queue&, const char*, WorkCount, const ShadeParticles<MaterialsKnown::PlainDiffuse>&);
} // namespace pertev
