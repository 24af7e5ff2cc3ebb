#include "device/launch_body.h"
#include "integrators/photon_map/estimate_radiance.h"

namespace pertev {
using enum MaterialsKnown;
template void launch(Queue&, const char*, WorkCount, const ShareLookups<Nothing>&);
template void launch(Queue&, const char*, WorkCount, const ShareLookups<PlainDiffuse>&);
template void launch(Queue&, const char*, WorkCount, const AddSharedLookups<Nothing>&);
template void launch(Queue&, const char*, WorkCount, const AddSharedLookups<PlainDiffuse>&);
} // namespace pertev
