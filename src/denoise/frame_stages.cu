#include "denoise/compare_light.h"
#include "denoise/keep_layers.h"
#include "denoise/motion_vectors.h"
#include "denoise/sum_blocks.h"
#include "denoise/upsample_picture.h"
#include "device/launch_body.h"

namespace pertev {
template void launch(Queue&, const char*, WorkCount, const CentreRays&);
template void launch(Queue&, const char*, WorkCount, const MotionOfHits&);
template void launch(Queue&, const char*, WorkCount, const CompareLight&);
template void launch(Queue&, const char*, WorkCount, const SpreadLight&);
template void launch(Queue&, const char*, WorkCount, const UpsamplePicture&);
template void launch(Queue&, const char*, WorkCount, const SumBlockRows&);
template void launch(Queue&, const char*, WorkCount, const MeanOfBlockRows&);
template void launch(Queue&, const char*, WorkCount, const KeepLayers&);
} // namespace pertev
