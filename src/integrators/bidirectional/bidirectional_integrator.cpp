#include "integrators/bidirectional/bidirectional.h"
#include "integrators/light_paths/walks_integrator_body.h"

namespace pertev {
template class WalksIntegrator<BothDirections>;
} // namespace pertev
