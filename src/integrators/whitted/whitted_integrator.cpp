#include "integrators/ray_tree/ray_tree_integrator_body.h"
#include "integrators/whitted/whitted.h"

namespace pertev {
template class RayTreeIntegrator<Whitted>;
} // namespace pertev
