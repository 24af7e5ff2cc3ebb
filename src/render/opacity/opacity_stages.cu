#include "device/launch_body.h"
#include "render/opacity/classify_opacity.h"

namespace pertev {
template void launch(Queue&, const char*, WorkCount, const HalveTexelBounds&);
template void launch(Queue&, const char*, WorkCount, const ClassifyOpacity&);
} // namespace pertev
