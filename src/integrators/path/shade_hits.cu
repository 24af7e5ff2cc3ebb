#include "device/launch_body.h"
#include "integrators/path/path_stages.h"

namespace pertev {
template void launch(Queue&, const char*, WorkCount,
                     const ShadeHits<MaterialsKnown::Nothing, false, false, MotionKnown::None>&);
template void launch(Queue&, const char*, WorkCount,
                     const ShadeHits<MaterialsKnown::Nothing, true, false, MotionKnown::None>&);
template void launch(Queue&, const char*, WorkCount,
                     const ShadeHits<MaterialsKnown::Diffuse, true, false, MotionKnown::None>&);
template void launch(Queue&, const char*, WorkCount,
                     const ShadeHits<MaterialsKnown::PlainDiffuse, true, false, MotionKnown::None>&);
} // namespace pertev
