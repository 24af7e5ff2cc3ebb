#include "device/launch_body.h"
#include "integrators/subpaths/particle_stages.h"

namespace pertev {
template void launch(Queue&, const char*, WorkCount, const BeginParticles&);
template void launch(Queue&, const char*, WorkCount, const BeginCameraSubpaths&);
template void launch(Queue&, const char*, WorkCount, const AddSplats&);
template void launch(Queue&, const char*, WorkCount, const AddConnections&);
template void launch(Queue&, const char*, WorkCount, const CountSubpaths&);
template void launch(Queue&, const char*, WorkCount, const BeginSubpaths&);
template void launch(Queue&, const char*, WorkCount, const ShadeParticles<ShadingVariant::General>&);
template void launch(Queue&, const char*, WorkCount, const ShadeParticles<ShadingVariant::PlainDiffuse>&);
} // namespace pertev
