#pragma once

// A map that light is looked up in: photons and the structure that finds them.

#include "accel/kd_tree/point_kd_tree.h"
#include "accel/octree/point_octree.h"
#include "integrators/photon_map/photon_grid.h"
#include "integrators/photon_map/photon_map_settings.h"
#include "integrators/photon_map/photons.h"

namespace pertev {

struct PhotonMapView {
    PhotonsView photons; // in the order of (path, scatterings)
    uint32_t count = 0;  // with those that are left out
    float radius = 0;    // metres, of the present pass
    PhotonGridView grid;
    PointKdTreeView kd_tree;
    PointOctreeView octree;
};

/// The map's structure of that kind.
template <PhotonSearch kSearch>
HD inline const auto& structure_of(const PhotonMapView& map) {
    if constexpr (kSearch == PhotonSearch::Grid) {
        return map.grid;
    } else if constexpr (kSearch == PhotonSearch::KdTree) {
        return map.kd_tree;
    } else {
        return map.octree;
    }
}

} // namespace pertev
