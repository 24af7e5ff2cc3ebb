#include "denoise/oidn/oidn_stages.h"
#include "device/launch_body.h"

namespace pertev {
template void launch(Queue&, const char*, WorkCount, const MeanOidnGuides&);
template void launch(Queue&, const char*, WorkCount, const ReadShownFrame&);
template void launch(Queue&, const char*, WorkCount, const ShowColor&);
} // namespace pertev
