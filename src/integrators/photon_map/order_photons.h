#pragma once

// From photons as they come to maps: the photons in the order of (path, scatterings), which no device or thread has a
// say in, and the buckets of the hash grid over them. Where photons crowd, as in the focus of a caustic, a look-up
// would take long for more of them than it needs: of a bucket no more than kMostKept stay, with the power of all. Dim
// light in the same bucket is noisier for that.
//
// Source: Suykens, Willems, "Density Control for Photon Maps", EGWR 2000, which gives the power of a photon that is
// left out to its neighbours; here chance chooses, so that the mean is that of all.

#include "device/buffer.h"
#include "integrators/photon_map/photon_map_view.h"
#include "math/random.h"

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

inline constexpr uint32_t kMostKept = 1024; // of a bucket's photons

/// Where buckets start, of sorted keys; thread `count` closes the list.
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

/// Puts photons into their buckets. Of n in one that has more than `most`, those of rank r stay for which the whole
/// part of (r * most + offset) / n is less than that for r + 1, `offset` drawn evenly from 0 to n - 1: `most` of them,
/// spread evenly over the numbers, each with the chance most / n. Their power is made up for the others'.
struct KeepPhotons {
    PhotonsView photons; // of the map alone; places' last number becomes 1 of those that stay, else 0
    const uint64_t* sorted_keys;
    const uint32_t* sorted_order;
    const uint32_t* starts;
    uint32_t most, pass, seed;
    Float4* points;

    HD void operator()(uint32_t i) const {
        const auto bucket = static_cast<uint32_t>(sorted_keys[i]);
        const uint32_t begin = starts[bucket], n = starts[bucket + 1] - begin, number = sorted_order[i];
        Float4& place = photons.places[number];
        uint32_t at = i;
        place.w = 1;
        if (n > most) {
            const uint64_t offset = uint64_t(hash_words(bucket, pass, seed, kDrawsOffset).x) * n >> 32;
            const uint64_t before = (uint64_t(i - begin) * most + offset) / n;
            if ((uint64_t(i - begin + 1) * most + offset) / n == before) {
                place.w = 0;
                return;
            }
            at = begin + static_cast<uint32_t>(before);
            Float4& power = photons.powers[number];
            const float all = static_cast<float>(n) / static_cast<float>(most);
            power = {all * power.x, all * power.y, all * power.z, power.w};
        }
        points[at] = {place.x, place.y, place.z, float_of(number)};
    }

private:
    static constexpr uint32_t kDrawsOffset = 0x6b656570; // no other draw has this word
};

/// Sorts `keys` of so many bits, 1 to 63, each with its number in `order`, of which order[i] is i; equal keys stay in
/// the order of numbers. What was in `keys` and `order` is lost. On the host by bytes, on a GPU by
/// tracer/hploc/sort_codes.h, whose `scratch` it is.
void sort_photons(Queue& queue, Buffer<std::byte>& scratch, uint64_t* keys, uint32_t* order, uint64_t* sorted_keys,
                  uint32_t* sorted_order, uint32_t count, int bits);

} // namespace pertev
