#include "integrators/cast/cast.h"
#include "integrators/ray_tree/ray_tree_integrator.h"

namespace pertev {
template class RayTreeIntegrator<Cast>;
} // namespace pertev
