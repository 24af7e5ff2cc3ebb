#include "device/launch_body.h"
#include "integrators/light/shade_seen.h"

namespace pertev {
template void launch(Queue&, const char*, WorkCount, const ShadeSeen&);
} // namespace pertev
