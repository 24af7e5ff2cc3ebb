#pragma once

// Owns the records of a picture and the octree over them. Only rounds tell how many records there are: memory is for
// max_records(), on the device and on the host.

#include <cstddef>
#include <cstdint>
#include <span>

#include "accel/octree/point_octree.h"
#include "device/buffer.h"
#include "integrators/irradiance_cache/irradiance_record.h"
#include "integrators/irradiance_cache/lookup_stages.h"

namespace pertev {

/// Host memory in which records are spaced.
struct SpacingMemory {
    Buffer<Sphere> spheres;    // [records] what a tree is built over
    Buffer<float> least_radii; // [nodes]
    Buffer<PointOctreeNode> nodes;
    Buffer<Sphere> tree_spheres;
    Buffer<uint32_t> indices, work;

    /// Allocates for at most `records` records.
    void grow(Queue& host, std::size_t records);
    PointOctreeSpace tree() const {
        return {{nodes.data(), nodes.size()},
                {tree_spheres.data(), tree_spheres.size()},
                {indices.data(), indices.size()},
                {work.data(), work.size()}};
    }
};

class RecordStore {
public:
    /// Makes an empty store; `queue` outlives it.
    explicit RecordStore(Queue& queue)
        : queue_(queue), host_(queue.is_dry_run() ? Queue::make_dry_run(false) : Queue::make_cpu(queue.threads())) {}

    /// Allocates for a picture of `pixels` pixels. Throws Error(OutOfMemory).
    void allocate(uint64_t pixels);
    /// Bytes of the host's memory besides the queue's.
    std::size_t host_bytes() const { return host_.allocated_bytes(); }

    /// Removes all records for a new picture.
    void clear() { count_ = node_count_ = 0; }
    uint32_t count() const { return count_; }

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
    Queue host_; // counts the host's memory
    uint64_t pixels_ = 0;
    float accuracy_ = 0;
    uint32_t count_ = 0, node_count_ = 0;
    Buffer<Sphere> spheres_;   // on the host: with the records' unclamped radii
    Buffer<float> luminances_; // on the host: luminance of the records' light
    Buffer<float> clamped_;    // on the host: radii of the last round
    SpacingMemory spacing_;
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

/// Clamps the radii of spheres around records to the minimum of radius_j + distance to j over all j, itself included.
void clamp_by_neighbours(std::span<const Sphere> records, const SpacingMemory& memory, std::span<float> clamped);

} // namespace pertev
