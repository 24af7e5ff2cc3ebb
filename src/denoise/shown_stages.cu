#include "denoise/keep_layers.h"
#include "denoise/sum_blocks.h"
#include "device/launch_body.h"

namespace pertev {
template void launch(Queue&, const char*, WorkCount, const SumBlockRows&);
template void launch(Queue&, const char*, WorkCount, const MeanOfBlockRows&);
template void launch(Queue&, const char*, WorkCount, const KeepLayers&);
} // namespace pertev
