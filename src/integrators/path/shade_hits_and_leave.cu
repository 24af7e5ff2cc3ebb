#include "device/launch_body.h"
#include "integrators/path/path_stages.h"

namespace pertev {
template void launch(Queue&, const char*, WorkCount,
                     const ShadeHits<MaterialsKnown::Nothing, true, true, MotionKnown::None>&);
template void launch(Queue&, const char*, WorkCount,
                     const ShadeHits<MaterialsKnown::Diffuse, true, true, MotionKnown::None>&);
template void launch(Queue&, const char*, WorkCount,
                     const ShadeHits<MaterialsKnown::PlainDiffuse, true, true, MotionKnown::None>&);
} // namespace pertev
