#include "device/launch_body.h"
#include "integrators/radiosity/radiosity.h"
#include "integrators/ray_tree/tree_stages.h"

namespace pertev {
template void launch(Queue&, const char*, WorkCount, const ShadeTrees<Radiosity, MotionVariant::None>&);
} // namespace pertev
