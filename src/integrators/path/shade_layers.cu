#include "device/launch_body.h"
#include "integrators/path/path_stages.h"

namespace pertev {
template void launch(Queue&, const char*, WorkCount, const Shade<kAllMaterials, LayerListeners>&);
template void launch(Queue&, const char*, WorkCount, const Shade<kAllMaterials | kMoving, LayerListeners>&);
} // namespace pertev
