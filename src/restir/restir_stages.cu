#include "device/launch_body.h"
#include "restir/add_direct_light.h"
#include "restir/add_indirect_light.h"
#include "restir/find_neighbours.h"
#include "restir/initial_candidates.h"
#include "restir/initial_gi_reservoirs.h"
#include "restir/reuse_reservoirs.h"

namespace pertev {
template void launch(Queue&, const char*, WorkCount, const SampleInitialCandidates&);
template void launch(Queue&, const char*, WorkCount, const MakeInitialGiReservoirs&);
template void launch(Queue&, const char*, WorkCount, const FindBefore&);
template void launch(Queue&, const char*, WorkCount, const FindNeighbours&);
template void launch(Queue&, const char*, WorkCount, const ReuseReservoirs<LightReservoir>&);
template void launch(Queue&, const char*, WorkCount, const QueueVisibilityRays<LightReservoir>&);
template void launch(Queue&, const char*, WorkCount, const CountVisible<LightReservoir>&);
template void launch(Queue&, const char*, WorkCount, const FinishReuse<LightReservoir>&);
template void launch(Queue&, const char*, WorkCount, const AddDirectLight&);
template void launch(Queue&, const char*, WorkCount, const ReuseReservoirs<BounceReservoir>&);
template void launch(Queue&, const char*, WorkCount, const QueueVisibilityRays<BounceReservoir>&);
template void launch(Queue&, const char*, WorkCount, const CountVisible<BounceReservoir>&);
template void launch(Queue&, const char*, WorkCount, const FinishReuse<BounceReservoir>&);
template void launch(Queue&, const char*, WorkCount, const AddIndirectLight&);
} // namespace pertev
