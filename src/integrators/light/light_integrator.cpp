#include "integrators/light/light.h"
#include "integrators/subpaths/walks_integrator.h"

namespace pertev {
template class WalksIntegrator<ParticlesAlone>;
} // namespace pertev
