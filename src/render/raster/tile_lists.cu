#include "device/launch_body.h"
#include "render/raster/find_in_tile.h"

namespace pertev {
template void launch(Queue&, const char*, WorkCount, const BinTriangles&);
template void launch(Queue&, const char*, WorkCount, const BinRows&);
template void launch(Queue&, const char*, WorkCount, const FinishTileLists&);
template void launch(Queue&, const char*, WorkCount, const FindInTiles&);
} // namespace pertev
