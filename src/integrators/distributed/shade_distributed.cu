#include "device/launch_body.h"
#include "integrators/distributed/distributed.h"
#include "integrators/ray_tree/tree_stages.h"

namespace pertev {
template void launch(Queue&, const char*, WorkCount, const ShadeTrees<Distributed, MotionVariant::None>&);
template void launch(Queue&, const char*, WorkCount, const ShadeTrees<Distributed, MotionVariant::Perhaps>&);
} // namespace pertev
