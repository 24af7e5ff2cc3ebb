#include "device/launch_body.h"
#include "integrators/photon_map/estimate_radiance.h"

namespace pertev {
using enum MaterialsKnown;
using Search = PhotonSearch;
template void launch(Queue&, const char*, WorkCount, const EstimateRadiance<Nothing, Search::Grid>&);
template void launch(Queue&, const char*, WorkCount, const EstimateRadiance<Nothing, Search::KdTree>&);
template void launch(Queue&, const char*, WorkCount, const EstimateRadiance<Nothing, Search::Octree>&);
template void launch(Queue&, const char*, WorkCount, const EstimateRadiance<PlainDiffuse, Search::Grid>&);
template void launch(Queue&, const char*, WorkCount, const EstimateRadiance<PlainDiffuse, Search::KdTree>&);
template void launch(Queue&, const char*, WorkCount, const EstimateRadiance<PlainDiffuse, Search::Octree>&);
template void launch(Queue&, const char*, WorkCount, const ShareLookups<Nothing>&);
template void launch(Queue&, const char*, WorkCount, const ShareLookups<PlainDiffuse>&);
template void launch(Queue&, const char*, WorkCount, const AddSharedLookups<Nothing>&);
template void launch(Queue&, const char*, WorkCount, const AddSharedLookups<PlainDiffuse>&);
} // namespace pertev
