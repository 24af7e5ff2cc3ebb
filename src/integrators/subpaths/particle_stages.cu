#include "device/launch_body.h"
#include "integrators/subpaths/begin_eyes.h"

// Those that compile soon: shading has a file of its own.
namespace pertev {
template void launch(Queue&, const char*, WorkCount, const BeginParticles&);
template void launch(Queue&, const char*, WorkCount, const BeginEyes&);
template void launch(Queue&, const char*, WorkCount, const AddSplats&);
template void launch(Queue&, const char*, WorkCount, const AddConnections&);
template void launch(Queue&, const char*, WorkCount, const CountWalks&);
template void launch(Queue&, const char*, WorkCount, const BeginWalks&);
} // namespace pertev
