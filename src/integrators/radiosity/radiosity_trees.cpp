#include "integrators/radiosity/radiosity.h"
#include "integrators/ray_tree/ray_tree_integrator_body.h"

namespace pertev {
template class RayTreeIntegrator<Radiosity>;
} // namespace pertev
