#include "render/centre_layers.h"

#include "device/launch_body.h"

namespace pertev {
template void launch(Queue&, const char*, WorkCount, const MakeCentreRays&);
template void launch(Queue&, const char*, WorkCount, const StoreCentres<ShadingVariant::PlainDiffuse, false>&);
template void launch(Queue&, const char*, WorkCount, const StoreCentres<ShadingVariant::General, false>&);
template void launch(Queue&, const char*, WorkCount, const StoreCentres<ShadingVariant::General, true>&);
} // namespace pertev
