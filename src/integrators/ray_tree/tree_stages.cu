#include "device/launch_body.h"
#include "integrators/ray_tree/tree_stages.h"

namespace pertev {
template void launch(Queue&, const char*, WorkCount, const BeginTrees&);
template void launch(Queue&, const char*, WorkCount, const BeginRounds&);
template void launch(Queue&, const char*, WorkCount, const AddTreeLight&);
template void launch(Queue&, const char*, WorkCount, const TakeNextRays&);
template void launch(Queue&, const char*, WorkCount, const CountTrees&);
} // namespace pertev
