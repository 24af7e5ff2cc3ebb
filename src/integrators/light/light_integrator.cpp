#include "integrators/light/light.h"
#include "integrators/subpaths/walks_integrator_body.h"

namespace pertev {
template class WalksIntegrator<ParticlesAlone>;
} // namespace pertev
