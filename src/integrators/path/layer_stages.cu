#include "device/launch_body.h"
#include "integrators/path/layer_stages.h"
#include "integrators/path/path_stages.h"

// And shading of what moves while the shutter is open.
namespace pertev {
template void launch(Queue&, const char*, WorkCount, const ShadeHitsToLayers&);
template void launch(Queue&, const char*, WorkCount, const ShadeHits<MaterialsKnown::Nothing, false, false, true>&);
template void launch(Queue&, const char*, WorkCount, const AddLightToLayers&);
} // namespace pertev
