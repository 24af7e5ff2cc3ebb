#include "device/launch_body.h"
#include "integrators/raster/shade_pixels.h"

namespace pertev {
template void launch(Queue&, const char*, WorkCount, const ShadePixels&);
} // namespace pertev
