#include "accel/builders/builders.h"

#include "accel/builders/build_bvh.h"
#include "base/error.h"

namespace pertev {

bool cuts_triangles(BvhBuilder builder) {
    return builder == BvhBuilder::SpatialSplits || builder == BvhBuilder::SpatialReinsertion;
}

Bvh build_bvh(BvhBuilder builder, const std::vector<BvhTriangle>& triangles, const BvhBuildSettings& settings) {
    switch (builder) {
    case BvhBuilder::Binned:
        return build_bvh(triangles, settings);
    case BvhBuilder::Sweep:
        return build_sweep_bvh(triangles, settings);
    case BvhBuilder::Median:
        return build_median_bvh(triangles, settings);
    case BvhBuilder::EqualCounts:
        return build_equal_counts_bvh(triangles, settings);
    case BvhBuilder::SpatialSplits:
        return build_spatial_split_bvh(triangles, settings);
    case BvhBuilder::Ploc:
        return build_ploc_bvh(triangles, settings);
    case BvhBuilder::Hploc:
        return build_hploc_bvh(triangles, settings);
    case BvhBuilder::Insertion:
        return build_insertion_bvh(triangles, settings);
    case BvhBuilder::Reinsertion:
        return optimise_bvh(build_bvh(triangles, settings), settings);
    case BvhBuilder::SpatialReinsertion:
        return build_spatial_reinsertion_bvh(triangles, settings);
    }
    PERTEV_CHECK(false);
}

} // namespace pertev
