#include "device/launch_body.h"
#include "tracer/refit_wide.h"

namespace pertev {
template void launch(Queue&, const char*, WorkCount, const ListTriangles&);
template void launch(Queue&, const char*, WorkCount, const LinkWideParents&);
template void launch(Queue&, const char*, WorkCount, const RefitWide&);
} // namespace pertev
