#include "device/launch_body.h"
#include "integrators/bidirectional/eye_stages.h"

namespace pertev {
template void launch(Queue&, const char*, WorkCount, const JoinWalks<MaterialsKnown::Nothing>&);
template void launch(Queue&, const char*, WorkCount, const JoinWalks<MaterialsKnown::PlainDiffuse>&);
} // namespace pertev
