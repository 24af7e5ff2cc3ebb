#pragma once

// From photons as they come to maps: the photons in the order of (path, scatterings), which no device or thread has a
// say in, and the buckets of the hash grid over them.

#include "device/buffer.h"
#include "integrators/photon_map/photon_grid.h"
#include "integrators/photon_map/photons.h"

namespace pertev {

/// order[i] = i.
struct NumberPhotons {
    uint32_t* order;
    HD void operator()(uint32_t i) const { order[i] = i; }
};

/// Photon i of the order, from where it was stored.
struct OrderPhotons {
    PhotonsView stored, ordered;
    const uint32_t* order;

    HD void operator()(uint32_t i) const {
        const uint32_t from = order[i];
        ordered.places[i] = stored.places[from];
        ordered.ways[i] = stored.ways[from];
        ordered.powers[i] = stored.powers[from];
    }
};

/// The key of photon i is its bucket.
struct MakeBuckets {
    const Float4* places;
    PhotonCells cells;
    uint64_t* keys;
    uint32_t* order;

    HD void operator()(uint32_t i) const {
        const Float4 p = places[i];
        keys[i] = cells.bucket_of({p.x, p.y, p.z});
        order[i] = i;
    }
};

/// Photon i by buckets; thread `count` closes the list.
struct FillBuckets {
    const Float4* places;
    const uint64_t* sorted_keys;
    const uint32_t* sorted_order;
    uint32_t count, buckets;
    Float4* points;
    uint32_t* starts;

    HD void operator()(uint32_t i) const {
        const uint32_t first = i > 0 ? static_cast<uint32_t>(sorted_keys[i - 1]) + 1 : 0;
        const uint32_t last = i < count ? static_cast<uint32_t>(sorted_keys[i]) : buckets;
        for (uint32_t bucket = first; bucket <= last; ++bucket) starts[bucket] = i;
        if (i == count) return;
        const uint32_t number = sorted_order[i];
        const Float4 p = places[number];
        points[i] = {p.x, p.y, p.z, float_of(number)};
    }
};

/// Sorts `keys` of so many bits, 1 to 63, each with its number in `order`, of which order[i] is i; equal keys stay in
/// the order of numbers. What was in `keys` and `order` is lost. On the host by bytes, on a GPU by
/// render/tracer/hploc/sort_codes.h, whose `scratch` it is.
void sort_photons(Queue& queue, Buffer<std::byte>& scratch, uint64_t* keys, uint32_t* order, uint64_t* sorted_keys,
                  uint32_t* sorted_order, uint32_t count, int bits);

} // namespace pertev
