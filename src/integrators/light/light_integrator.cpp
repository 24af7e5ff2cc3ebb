#include "integrators/light/light.h"
#include "integrators/light_paths/walks_integrator_body.h"

namespace pertev {
template class WalksIntegrator<ParticlesAlone>;
} // namespace pertev
