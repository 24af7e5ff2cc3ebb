#include "device/launch_body.h"
#include "integrators/light/light.h"

namespace pertev {
template void launch(Queue&, const char*, WorkCount, const ShadeSeen&);
} // namespace pertev
