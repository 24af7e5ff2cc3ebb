#include "device/launch_body.h"
#include "integrators/path/path_stages.h"

namespace pertev {
template void launch(Queue&, const char*, WorkCount, const ShadeHits<MaterialsKnown::Nothing, false, false, false>&);
template void launch(Queue&, const char*, WorkCount, const ShadeHits<MaterialsKnown::Nothing, true, false, false>&);
template void launch(Queue&, const char*, WorkCount, const ShadeHits<MaterialsKnown::Diffuse, true, false, false>&);
template void launch(Queue&, const char*, WorkCount,
                     const ShadeHits<MaterialsKnown::PlainDiffuse, true, false, false>&);
} // namespace pertev
