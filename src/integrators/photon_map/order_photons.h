#pragma once

// Turns stored photons into maps: sorts them by (path, scatterings), independently of device and threads, and makes
// the buckets of the hash grid. Where photons crowd, as in the focus of a caustic, lookups would take long for more
// photons than they need. Therefore at most kMaxKept photons of a bucket stay, with the power of all. That makes dim
// light in the same bucket noisier.
//
// Source: Suykens, Willems, "Density Control for Photon Maps", EGWR 2000, which distributes the power of a removed
// photon to its neighbours; here selection is random, so that the mean is that of all.

#include "device/buffer.h"
#include "integrators/photon_map/photon_map_view.h"
#include "math/random.h"

namespace pertev {

/// The stage that sets order[i] = i.
struct NumberPhotons {
    uint32_t* order;
    HD void operator()(uint32_t i) const { order[i] = i; }
};

/// The stage that moves photon i of the order from where it was stored.
struct OrderPhotons {
    PhotonsView stored, ordered;
    const uint32_t* order;

    HD void operator()(uint32_t i) const {
        const uint32_t from = order[i];
        ordered.positions[i] = stored.positions[from];
        ordered.directions[i] = stored.directions[from];
        ordered.powers[i] = stored.powers[from];
    }
};

/// The stage that sets the key of photon i to its bucket.
struct MakeBuckets {
    const Float4* positions;
    PhotonCells cells;
    uint64_t* keys;
    uint32_t* order;

    HD void operator()(uint32_t i) const {
        const Float4 p = positions[i];
        keys[i] = cells.bucket_of({p.x, p.y, p.z});
        order[i] = i;
    }
};

inline constexpr uint32_t kMaxKept = 1024; // photons per bucket

/// The stage that finds the starts of buckets in sorted keys; thread `count` closes the list.
struct FindBuckets {
    const uint64_t* sorted_keys;
    uint32_t count, buckets;
    uint32_t* starts; // [buckets + 1]

    HD void operator()(uint32_t i) const {
        const uint32_t first = i > 0 ? static_cast<uint32_t>(sorted_keys[i - 1]) + 1 : 0;
        const uint32_t last = i < count ? static_cast<uint32_t>(sorted_keys[i]) : buckets;
        for (uint32_t bucket = first; bucket <= last; ++bucket) starts[bucket] = i;
    }
};

/// The stage that puts photons into their buckets. If a bucket has n > `most` photons, that of rank r stays if the
/// integer part of (r * most + offset) / n is less than that for r + 1, with `offset` uniform from 0 to n - 1. These
/// are `most` photons, evenly spread over the ranks, each with probability most / n. Their power is scaled to
/// compensate for the others.
struct KeepPhotons {
    PhotonsView photons; // the map's photons; the last component of places becomes 1 for those that stay, else 0
    const uint64_t* sorted_keys;
    const uint32_t* sorted_order;
    const uint32_t* starts;
    uint32_t most, pass, seed;
    Float4* points;

    HD void operator()(uint32_t i) const {
        const auto bucket = static_cast<uint32_t>(sorted_keys[i]);
        const uint32_t begin = starts[bucket], n = starts[bucket + 1] - begin, number = sorted_order[i];
        Float4& position = photons.positions[number];
        uint32_t at = i;
        position.w = 1;
        if (n > most) {
            const uint64_t offset = uint64_t(hash_words(bucket, pass, seed, kDrawsOffset).x) * n >> 32;
            const uint64_t before = (uint64_t(i - begin) * most + offset) / n;
            if ((uint64_t(i - begin + 1) * most + offset) / n == before) {
                position.w = 0;
                return;
            }
            at = begin + static_cast<uint32_t>(before);
            Float4& power = photons.powers[number];
            const float all = static_cast<float>(n) / static_cast<float>(most);
            power = {all * power.x, all * power.y, all * power.z, power.w};
        }
        points[at] = {position.x, position.y, position.z, float_of(number)};
    }

private:
    static constexpr uint32_t kDrawsOffset = 0x6b656570; // unique among the random draws
};

/// Sorts `keys` with `bits` bits, 1 to 63, each with its index in `order`, where order[i] is i; equal keys keep their
/// order. The contents of `keys` and `order` are lost. It is a radix sort on the host; a GPU uses
/// tracer/hploc/sort_codes.h with `scratch`.
void sort_photons(Queue& queue, Buffer<std::byte>& scratch, uint64_t* keys, uint32_t* order, uint64_t* sorted_keys,
                  uint32_t* sorted_order, uint32_t count, int bits);

} // namespace pertev
