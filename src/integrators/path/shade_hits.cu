#include "device/launch_body.h"
#include "integrators/path/path_stages.h"

namespace pertev {
template void launch(Queue&, const char*, WorkCount, const ShadeHits<MaterialsKnown::Nothing>&);
template void launch(Queue&, const char*, WorkCount, const ShadeHits<MaterialsKnown::Diffuse>&);
template void launch(Queue&, const char*, WorkCount, const ShadeHits<MaterialsKnown::PlainDiffuse>&);
} // namespace pertev
