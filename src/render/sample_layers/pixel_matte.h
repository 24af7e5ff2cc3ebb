#pragma once

// The names that a pixel shows, as ids with their numbers of samples.
//
// A pixel with more ids than fit keeps the smallest. These depend only on the set of its samples, so that neither the
// order of samples nor their division into parts or among devices matters: an id that is among the smallest of all
// samples is so among those of each part, which thus has counted all of its own.

#include "math/bits.h"
#include "trace/intersect/ray.h"

namespace pertev {

inline constexpr uint32_t kMatteIds = 16;  // that a pixel keeps
inline constexpr uint32_t kMatteRanks = 8; // that files have, two in a layer: those that cover most
inline constexpr uint32_t kNoMatte = ~0u;

/// Ids and their numbers of samples, in the order of ids. kNoMatte follows the last one.
struct PixelMatte {
    uint32_t ids[kMatteIds], samples[kMatteIds];

    HD void take(uint32_t id, uint32_t count) {
        uint32_t i = 0;
        while (i < kMatteIds && ids[i] < id) ++i;
        if (i == kMatteIds) return;
        if (ids[i] == id) {
            samples[i] += count;
            return;
        }
        for (uint32_t k = kMatteIds - 1; k > i; --k) ids[k] = ids[k - 1], samples[k] = samples[k - 1];
        ids[i] = id, samples[i] = count;
    }
};

/// The stage that adds pixels, with one call per pixel.
struct AddMattes {
    const PixelMatte* from;
    PixelMatte* to;

    HD void operator()(uint32_t i) const {
        for (uint32_t k = 0; k < kMatteIds && from[i].ids[k] != kNoMatte; ++k)
            to[i].take(from[i].ids[k], from[i].samples[k]);
    }
};

} // namespace pertev
