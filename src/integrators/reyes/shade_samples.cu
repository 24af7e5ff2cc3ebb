#include "device/launch_body.h"
#include "integrators/reyes/shade_samples.h"

namespace pertev {
template void launch(Queue&, const char*, WorkCount, const ShadeSamples&);
} // namespace pertev
