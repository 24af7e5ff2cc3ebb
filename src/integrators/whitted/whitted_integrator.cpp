#include "integrators/ray_tree/ray_tree_integrator.h"
#include "integrators/whitted/whitted.h"

namespace pertev {
template class RayTreeIntegrator<Whitted>;
} // namespace pertev
