#pragma once

// Owns both maps of a pass and the memory to build them, for all photons that a pass may store.

#include <cstddef>
#include <cstdint>

#include "base/sink.h"
#include "device/buffer.h"
#include "integrators/photon_map/estimate_radiance.h"
#include "integrators/photon_map/photon_map_view.h"

namespace pertev {

/// Radii of a pass, in metres.
struct PhotonRadii {
    float global, caustic, in_media;
};

class PhotonMaps {
public:
    /// Makes empty maps; `queue` outlives them.
    explicit PhotonMaps(Queue& queue) : queue_(queue) {}

    /// Allocates for passes with these settings. Throws Error(OutOfMemory).
    void allocate(const PhotonMapSettings& settings, uint32_t max_depth, bool has_media);

    /// Starts a pass: empties the maps and returns the arrays that photons are appended to.
    StoredPhotonsView clear();
    /// Builds the maps from the photons of pass `pass`. `largest` is the largest |coordinate| of any point. Waits for
    /// the device. Throws Error(Interrupted) if `sink` stops the building of a tree.
    const PhotonMapsView& build(const PhotonRadii& radii, float largest, uint32_t pass, uint32_t seed, Sink& sink);
    /// Counts of the last build().
    const PhotonCounts& counts() const { return found_; }
    const PhotonMapsView& view() const { return view_; }
    /// Photons stored in media.
    const PhotonMapView& in_media() const { return in_media_; }

private:
    PhotonsView ordered() const { return {ordered_[0].data(), ordered_[1].data(), ordered_[2].data()}; }
    void fill_grid(PhotonMapView& map, Float4* points, Buffer<uint32_t>& starts, float largest, uint32_t pass,
                   uint32_t seed);
    void build_trees(PhotonMapView& map, uint32_t first, Sink& sink);

    Queue& queue_;
    PhotonSearch search_ = PhotonSearch::Grid;
    bool global_has_all_ = false;
    uint32_t max_kept_ = 0;       // photons per bucket
    uint64_t capacity_ = 0;       // in photons
    Buffer<Float4> stored_[3];    // stored photons; then the points of the grids: [0] of the global map, [1] of the
                                  // caustic map, [2] of that in media
    Buffer<Float4> ordered_[3];   // in the order of their numbers: global, caustic, in media; then, if the global map
                                  // has all, the caustic map
    Buffer<uint64_t> keys_[2];    // [0] as stored, [1] sorted
    Buffer<uint32_t> order_[2];   // [0] as stored, [1] sorted
    Buffer<uint32_t> starts_[3];  // starts of buckets: [0] of the global map, [1] of the caustic map, [2] in media
    Buffer<std::byte> scratch_;   // memory for sorting
    Buffer<PhotonCounts> counts_; // the counts of a pass, an array of one element
    // Only one of these three structures is filled; global photons come first.
    Buffer<PointKdNode> kd_nodes_;
    Buffer<PointOctreeNode> octree_nodes_;
    Buffer<Sphere> octree_spheres_;
    Buffer<uint32_t> octree_indices_;
    PhotonCounts found_{};
    PhotonMapsView view_;
    PhotonMapView in_media_;
};

} // namespace pertev
