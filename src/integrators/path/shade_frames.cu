#include "device/launch_body.h"
#include "integrators/path/path_stages.h"

namespace pertev {
template void launch(Queue&, const char*, WorkCount, const Shade<kPlainDiffuse, PlainFrameListeners>&);
template void launch(Queue&, const char*, WorkCount, const Shade<kDiffuse, PlainFrameListeners>&);
template void launch(Queue&, const char*, WorkCount, const Shade<kAllMaterials, FrameListeners>&);
} // namespace pertev
