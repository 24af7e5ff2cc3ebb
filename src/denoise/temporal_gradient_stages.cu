#include "denoise/compare_light.h"
#include "device/launch_body.h"

namespace pertev {
template void launch(Queue&, const char*, WorkCount, const CompareLight&);
template void launch(Queue&, const char*, WorkCount, const SpreadLight&);
} // namespace pertev
