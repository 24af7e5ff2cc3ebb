#include "device/launch_body.h"
#include "integrators/bidirectional/camera_subpath_stages.h"

namespace pertev {
template void launch(Queue&, const char*, WorkCount, const ShadeCameraSubpaths<ShadingVariant::General>&);
template void launch(Queue&, const char*, WorkCount, const ShadeCameraSubpaths<ShadingVariant::PlainDiffuse>&);
template void launch(Queue&, const char*, WorkCount, const ConnectSubpaths<ShadingVariant::General>&);
template void launch(Queue&, const char*, WorkCount, const ConnectSubpaths<ShadingVariant::PlainDiffuse>&);
} // namespace pertev
