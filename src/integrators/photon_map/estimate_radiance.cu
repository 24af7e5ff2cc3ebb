#include "device/launch_body.h"
#include "integrators/photon_map/estimate_radiance.h"

namespace pertev {
using enum MaterialsKnown;
using enum PhotonSearch;
template void launch(Queue&, const char*, WorkCount, const EstimateRadiance<Nothing, Grid>&);
template void launch(Queue&, const char*, WorkCount, const EstimateRadiance<Nothing, KdTree>&);
template void launch(Queue&, const char*, WorkCount, const EstimateRadiance<Nothing, Octree>&);
template void launch(Queue&, const char*, WorkCount, const EstimateRadiance<PlainDiffuse, Grid>&);
template void launch(Queue&, const char*, WorkCount, const EstimateRadiance<PlainDiffuse, KdTree>&);
template void launch(Queue&, const char*, WorkCount, const EstimateRadiance<PlainDiffuse, Octree>&);
} // namespace pertev
