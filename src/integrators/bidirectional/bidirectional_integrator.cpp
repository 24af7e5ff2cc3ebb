#include "integrators/bidirectional/bidirectional.h"
#include "integrators/subpaths/walks_integrator.h"

namespace pertev {
template class WalksIntegrator<BothDirections>;
} // namespace pertev
