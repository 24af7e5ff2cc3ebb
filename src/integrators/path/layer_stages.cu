#include "device/launch_body.h"
#include "integrators/path/layer_stages.h"

namespace pertev {
template void launch(Queue&, const char*, WorkCount, const ShadeHitsToLayers<MotionKnown::None>&);
template void launch(Queue&, const char*, WorkCount, const ShadeHitsToLayers<MotionKnown::Some>&);
template void launch(Queue&, const char*, WorkCount, const AddLightToLayers&);
} // namespace pertev
