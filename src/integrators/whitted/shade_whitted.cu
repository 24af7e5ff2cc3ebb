#include "device/launch_body.h"
#include "integrators/ray_tree/tree_stages.h"
#include "integrators/whitted/whitted.h"

namespace pertev {
template void launch(Queue&, const char*, WorkCount, const ShadeTrees<Whitted, MotionVariant::None>&);
template void launch(Queue&, const char*, WorkCount, const ShadeTrees<Whitted, MotionVariant::Perhaps>&);
} // namespace pertev
