#pragma once

// Owns both maps of a pass and what it takes to build them: memory for all photons that a pass may leave.

#include <cstddef>
#include <cstdint>

#include "device/buffer.h"
#include "integrators/photon_map/estimate_radiance.h"
#include "integrators/photon_map/photon_map_view.h"

namespace pertev {

class PhotonMaps {
public:
    /// `queue` outlives it.
    explicit PhotonMaps(Queue& queue) : queue_(queue) {}

    /// For passes of such settings. Throws Error(OutOfMemory).
    void make_room(const PhotonMapSettings& settings, uint32_t max_depth);

    /// A pass begins: no photons. Where they go.
    StoredPhotonsView clear();
    /// What was stored in pass `pass` becomes maps. `largest`: |coordinate| of any place. Waits for the device.
    const PhotonMapsView& build(float global_radius, float caustic_radius, float largest, uint32_t pass, uint32_t seed);
    /// Of the last build().
    const PhotonCounts& counts() const { return found_; }
    const PhotonMapsView& view() const { return view_; }

private:
    PhotonsView ordered() const { return {ordered_[0].data(), ordered_[1].data(), ordered_[2].data()}; }
    void fill_grid(PhotonMapView& map, Float4* points, Buffer<uint32_t>& starts, float largest, uint32_t pass,
                   uint32_t seed);
    void build_trees(PhotonMapView& map, uint32_t first);

    Queue& queue_;
    PhotonSearch search_ = PhotonSearch::Grid;
    bool global_has_all_ = false;
    uint32_t most_kept_ = 0;      // of a bucket's photons
    uint64_t room_ = 0;           // photons
    Buffer<Float4> stored_[3];    // of stored photons; then those of the grids: [0] of the global one, [1] of the other
    Buffer<Float4> ordered_[3];   // in the order of their numbers; of the global map, then of the caustic map
    Buffer<uint64_t> keys_[2];    // as they come; sorted
    Buffer<uint32_t> order_[2];   // likewise
    Buffer<uint32_t> starts_[2];  // of buckets: of the global map, of the caustic map
    Buffer<std::byte> scratch_;   // of sorting
    Buffer<PhotonCounts> counts_; // one
    // Of one kind alone; global photons first.
    Buffer<PointKdNode> kd_nodes_;
    Buffer<PointOctreeNode> octree_nodes_;
    Buffer<Sphere> octree_spheres_;
    Buffer<uint32_t> octree_indices_;
    PhotonCounts found_{};
    PhotonMapsView view_;
};

} // namespace pertev
