#include "device/launch_body.h"
#include "restir/add_direct_light.h"
#include "restir/add_indirect_light.h"
#include "restir/draw_candidates.h"
#include "restir/find_neighbours.h"
#include "restir/reuse_reservoirs.h"
#include "restir/take_bounces.h"

namespace pertev {
template void launch(Queue&, const char*, WorkCount, const DrawCandidates&);
template void launch(Queue&, const char*, WorkCount, const TakeBounces&);
template void launch(Queue&, const char*, WorkCount, const FindBefore&);
template void launch(Queue&, const char*, WorkCount, const FindBeside&);
template void launch(Queue&, const char*, WorkCount, const ReuseReservoirs<LightReservoir>&);
template void launch(Queue&, const char*, WorkCount, const AskForSight<LightReservoir>&);
template void launch(Queue&, const char*, WorkCount, const CountSight<LightReservoir>&);
template void launch(Queue&, const char*, WorkCount, const FinishReuse<LightReservoir>&);
template void launch(Queue&, const char*, WorkCount, const AddDirectLight&);
template void launch(Queue&, const char*, WorkCount, const ReuseReservoirs<BounceReservoir>&);
template void launch(Queue&, const char*, WorkCount, const AskForSight<BounceReservoir>&);
template void launch(Queue&, const char*, WorkCount, const CountSight<BounceReservoir>&);
template void launch(Queue&, const char*, WorkCount, const FinishReuse<BounceReservoir>&);
template void launch(Queue&, const char*, WorkCount, const AddIndirectLight&);
} // namespace pertev
