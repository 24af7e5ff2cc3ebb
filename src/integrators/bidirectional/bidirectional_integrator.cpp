#include "integrators/bidirectional/bidirectional.h"
#include "integrators/subpaths/walks_integrator_body.h"

namespace pertev {
template class WalksIntegrator<BothDirections>;
} // namespace pertev
