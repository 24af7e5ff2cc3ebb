#include "device/launch_body.h"
#include "integrators/raster/scan_triangles.h"
#include "integrators/raster/shade_pixels.h"

namespace pertev {
template void launch(Queue&, const char*, WorkCount, const ScanTriangles&);
template void launch(Queue&, const char*, WorkCount, const ScanRows&);
template void launch(Queue&, const char*, WorkCount, const DrawEdges&);
template void launch(Queue&, const char*, WorkCount, const ShadePixels&);
template void launch(Queue&, const char*, WorkCount, const InWindow<ShadePixels>&);
} // namespace pertev
