#include "device/launch_body.h"
#include "integrators/photon_map/estimate_radiance.h"

namespace pertev {
using enum ShadingVariant;
using Search = PhotonSearch;
template void launch(Queue&, const char*, WorkCount, const EstimateRadiance<General, Search::Grid>&);
template void launch(Queue&, const char*, WorkCount, const EstimateRadiance<Unstacked, Search::Grid>&);
template void launch(Queue&, const char*, WorkCount, const EstimateRadiance<General, Search::KdTree>&);
template void launch(Queue&, const char*, WorkCount, const EstimateRadiance<General, Search::Octree>&);
template void launch(Queue&, const char*, WorkCount, const EstimateRadiance<PlainDiffuse, Search::Grid>&);
template void launch(Queue&, const char*, WorkCount, const ShareLookups<General>&);
template void launch(Queue&, const char*, WorkCount, const ShareLookups<Unstacked>&);
template void launch(Queue&, const char*, WorkCount, const ShareLookups<PlainDiffuse>&);
template void launch(Queue&, const char*, WorkCount, const AddSharedLookups<General>&);
template void launch(Queue&, const char*, WorkCount, const AddSharedLookups<Unstacked>&);
template void launch(Queue&, const char*, WorkCount, const AddSharedLookups<PlainDiffuse>&);
} // namespace pertev
