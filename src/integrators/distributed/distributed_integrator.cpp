#include "integrators/distributed/distributed.h"
#include "integrators/ray_tree/ray_tree_integrator.h"

namespace pertev {
template class RayTreeIntegrator<Distributed>;
} // namespace pertev
