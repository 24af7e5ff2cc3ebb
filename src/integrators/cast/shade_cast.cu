#include "device/launch_body.h"
#include "integrators/cast/cast.h"
#include "integrators/ray_tree/tree_stages.h"

namespace pertev {
template void launch(Queue&, const char*, WorkCount, const ShadeTrees<Cast, MotionVariant::None>&);
template void launch(Queue&, const char*, WorkCount, const ShadeTrees<Cast, MotionVariant::Perhaps>&);
} // namespace pertev
