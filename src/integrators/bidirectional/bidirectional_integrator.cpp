#include "integrators/bidirectional/bidirectional.h"
#include "integrators/subpaths/subpath_integrator.h"

namespace pertev {
template class SubpathIntegrator<BothDirections>;
} // namespace pertev
