#include "integrators/light/light.h"
#include "integrators/subpaths/subpath_integrator.h"

namespace pertev {
template class SubpathIntegrator<ParticlesAlone>;
} // namespace pertev
