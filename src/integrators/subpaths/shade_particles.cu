#include "device/launch_body.h"
#include "integrators/subpaths/particle_stages.h"

namespace pertev {
template void launch(Queue&, const char*, WorkCount, const ShadeParticles<MaterialsKnown::Nothing>&);
template void launch(Queue&, const char*, WorkCount, const ShadeParticles<MaterialsKnown::PlainDiffuse>&);
} // namespace pertev
