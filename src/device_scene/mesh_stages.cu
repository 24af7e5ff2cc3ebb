#include "device/launch_body.h"
#include "device_scene/classify_opacity.h"
#include "scene/deform_vertices.h"

namespace pertev {
template void launch(Queue&, const char*, WorkCount, const DeformVertices&);
template void launch(Queue&, const char*, WorkCount, const HalveTexelBounds&);
template void launch(Queue&, const char*, WorkCount, const ClassifyOpacity&);
} // namespace pertev
