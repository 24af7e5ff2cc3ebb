#include "device/launch_body.h"
#include "scene/deform_vertices.h"

namespace pertev {
template void launch(Queue&, const char*, WorkCount, const DeformVertices&);
} // namespace pertev
