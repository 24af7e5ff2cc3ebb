#include "denoise/motion_vectors.h"
#include "device/launch_body.h"

namespace pertev {
template void launch(Queue&, const char*, WorkCount, const CentreRays&);
template void launch(Queue&, const char*, WorkCount, const MotionOfHits&);
} // namespace pertev
