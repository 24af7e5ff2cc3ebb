#include "device/launch_body.h"
#include "integrators/bidirectional/eye_stages.h"

namespace pertev {
template void launch(Queue&, const char*, WorkCount, const ShadeEyes<MaterialsKnown::Nothing>&);
template void launch(Queue&, const char*, WorkCount, const ShadeEyes<MaterialsKnown::PlainDiffuse>&);
template void launch(Queue&, const char*, WorkCount, const JoinWalks<MaterialsKnown::Nothing>&);
template void launch(Queue&, const char*, WorkCount, const JoinWalks<MaterialsKnown::PlainDiffuse>&);
} // namespace pertev
