#include "device/launch_body.h"
#include "integrators/path/path_stages.h"

// Of what moves while the shutter is open, or of a camera alone that does.
namespace pertev {
template void launch(Queue&, const char*, WorkCount,
                     const ShadeHits<MaterialsKnown::Nothing, false, false, MotionKnown::Some>&);
template void launch(Queue&, const char*, WorkCount,
                     const ShadeHits<MaterialsKnown::Diffuse, false, false, MotionKnown::Some>&);
template void launch(Queue&, const char*, WorkCount,
                     const ShadeHits<MaterialsKnown::PlainDiffuse, false, false, MotionKnown::Some>&);
template void launch(Queue&, const char*, WorkCount,
                     const ShadeHits<MaterialsKnown::Nothing, false, false, MotionKnown::Perhaps>&);
} // namespace pertev
