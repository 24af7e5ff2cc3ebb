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
    /// `queue` outlives it.
    explicit RecordStore(Queue& queue) : queue_(queue) {}

    /// Bytes that it takes beside of the host's memory, for the octree and the spacing of records, at most.
    static std::size_t most_host_bytes(uint64_t pixels);
    /// For a picture of so many pixels. Throws Error(OutOfMemory).
    void make_room(uint64_t pixels);
    /// The most that it has taken of the host's memory.
    std::size_t host_bytes() const { return host_bytes_; }

    /// A picture begins: no records.
    void clear();
    uint32_t count() const { return static_cast<uint32_t>(spheres_.size()); }

    /// [pixels] of the overture.
    RecordSite* sites() const { return sites_.data(); }
    /// Of the first `count` sites those that records are wanted for come first, in their order, as many as there is
    /// room for. Returns how many.
    uint32_t gather_sites(uint32_t count);
    /// Where the next records go: number count() is the first.
    IrradianceRecord* records() const { return records_.data(); }
    /// So many have been made: they serve from here on, and all are spaced anew.
    void take(uint32_t made, float accuracy);

    IrradianceCacheView view() const;
    /// Mean of the luminance of all records' light, W/(sr m2).
    float mean_luminance() const;

private:
    Queue& queue_;
    uint64_t pixels_ = 0;
    float accuracy_ = 0;
    std::vector<Sphere> spheres_;   // of their own radii
    std::vector<float> luminances_; // of their light
    std::size_t host_bytes_ = 0;
    uint32_t node_count_ = 0;
    Buffer<RecordSite> sites_;
    Buffer<IrradianceRecord> records_;
    Buffer<float> reaches_;
    Buffer<PointOctreeNode> nodes_;
    Buffer<Sphere> tree_spheres_;
    Buffer<uint32_t> tree_indices_;
};

// How far records serve, once all of a round are there: neighbour clamping. Where a record has near walls, those near
// it cannot be much farther from them, whatever their own rays have met: by the triangle inequality a radius is at most
// a neighbour's plus the way there. Of all records at once, so no order matters.
//
// Source: Krivanek, Bouatouch, Pattanaik, Zara, "Making Radiance and Irradiance Caching Practical: Adaptive Caching and
// Neighbor Clamping", EGSR 2006, section 5.

/// Of spheres round records, of their own radii: the least of radius_j + distance to j over all j, themselves too.
std::vector<float> clamp_by_neighbours(std::span<const Sphere> records);

} // namespace pertev
