#pragma once

// Owns the records of a picture and the octree over them.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "accel/octree/point_octree.h"
#include "device/buffer.h"
#include "integrators/irradiance_cache/irradiance_record.h"
#include "integrators/irradiance_cache/lookup_stages.h"

namespace pertev {

class RecordStore {
public:
    /// Makes an empty store; `queue` outlives it.
    explicit RecordStore(Queue& queue) : queue_(queue) {}

    /// Maximum additional host memory, in bytes, for the octree and the spacing of records.
    static std::size_t max_host_bytes(uint64_t pixels);
    /// Allocates for a picture of `pixels` pixels. Throws Error(OutOfMemory).
    void allocate(uint64_t pixels);
    /// Maximum host memory that the store has taken, in bytes.
    std::size_t host_bytes() const { return host_bytes_; }

    /// Removes all records for a new picture.
    void clear();
    uint32_t count() const { return static_cast<uint32_t>(spheres_.size()); }

    /// [pixels] sites of the overture.
    RecordSite* sites() const { return sites_.data(); }
    /// Moves the requested sites among the first `count` to the front in their order, as many as fit, and returns their
    /// number.
    uint32_t gather_sites(uint32_t count);
    /// Memory of the next records; the first has index count().
    IrradianceRecord* records() const { return records_.data(); }
    /// Adds `made` new records, which lookups use from now on, and recomputes the spacing of all.
    void take(uint32_t made, float accuracy);

    IrradianceCacheView view() const;
    /// Mean luminance of all records' light, W/(sr m2).
    float mean_luminance() const;

private:
    Queue& queue_;
    uint64_t pixels_ = 0;
    float accuracy_ = 0;
    std::vector<Sphere> spheres_;   // with the records' unclamped radii
    std::vector<float> luminances_; // luminance of the records' light
    std::size_t host_bytes_ = 0;
    uint32_t node_count_ = 0;
    Buffer<RecordSite> sites_;
    Buffer<IrradianceRecord> records_;
    Buffer<float> reaches_;
    Buffer<PointOctreeNode> nodes_;
    Buffer<Sphere> tree_spheres_;
    Buffer<uint32_t> tree_indices_;
};

// Neighbour clamping of all radii, after each round. If a record is close to a wall, records near it cannot be much
// farther from it, whatever their own rays have hit: by the triangle inequality a radius is at most a neighbour's
// plus the distance. All records are clamped at once, so their order does not matter.
//
// Source: Krivanek, Bouatouch, Pattanaik, Zara, "Making Radiance and Irradiance Caching Practical: Adaptive Caching
// and Neighbor Clamping", EGSR 2006, section 5.

/// Clamps the radii of spheres around records: returns the minimum of radius_j + distance to j over all j, itself
/// included.
std::vector<float> clamp_by_neighbours(std::span<const Sphere> records);

} // namespace pertev
