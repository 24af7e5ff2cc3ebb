#include "device/launch_body.h"
#include "integrators/reyes/shade_samples.h"
#include "integrators/reyes/split_stages.h"

namespace pertev {
template void launch(Queue&, const char*, WorkCount, const PositionSamples&);
template void launch(Queue&, const char*, WorkCount, const FindFar&);
template void launch(Queue&, const char*, WorkCount, const TakePieces&);
template void launch(Queue&, const char*, WorkCount, const SplitPieces<HidingPass::FindNearest>&);
template void launch(Queue&, const char*, WorkCount, const SplitPieces<HidingPass::FindMicropolygon>&);
template void launch(Queue&, const char*, WorkCount, const ShadeSamples&);
template void launch(Queue&, const char*, WorkCount, const InWindow<ShadeSamples>&);
} // namespace pertev
