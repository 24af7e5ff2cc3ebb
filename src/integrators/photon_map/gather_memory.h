#pragma once

// What walks of photon mapping know beside subpaths/walk_memory.h: what a mirror at their end may show, and the places
// where light is to be looked up in the maps.

#include "accel/nearest_points.h"
#include "integrators/subpaths/walk_memory.h"
#include "render/fixed_sum.h"

namespace pertev {

/// Of a walk from the camera, beside its throughput.
struct Sight {
    Rgb past_mirrors; // of the throughput, what counts of light met behind mirrors and smooth glass alone: the rest of
                      // that is in the caustic map
    float pdf;        // with which the ray's direction was drawn, 1/sr; 0 after the camera or a delta lobe
};

/// A diffuse surface at which a walk ends or turns.
struct Lookup {
    Hit hit;
    Vec3 direction; // of the walk, unit
    Rgb throughput;
    uint32_t pixel, scatterings; // so far
    bool wants_all;              // of both maps; else of the caustic map alone
};

/// What photons of both maps send on at a place, W/sr.
struct GatheredSums {
    FixedSum caustic[3], global[3];
};

/// How much there is room for.
struct GatherRoom {
    uint32_t count;   // walks
    uint32_t nearest; // photons of each walk; 0: all within a radius count
    bool can_share;   // look-ups between several threads
};

struct GatherView {
    Float4* sights;  // [walks] of a photon index_squared alone
    uint32_t* marks; // [walks] 1: of a photon, scattered otherwise than by delta lobes; of a walk from the camera, it
                     // has turned at a diffuse surface
    // Lookups of a round, side by side; WalkCounts::vertices is their number.
    Float4 *places, *directions, *throughputs;
    NearPoint* nearest; // [walks * nearest_count]
    uint32_t nearest_count;
    // Lookups of a round near which photons crowd: several threads share each. WalkCounts::crowded is their number.
    uint32_t* crowded = nullptr; // [walks] numbers of lookups; null: none is shared
    GatheredSums* shared_sums;   // [walks]

    HD void store_sight(uint32_t walk, const Sight& sight) const {
        sights[walk] = {sight.past_mirrors.r, sight.past_mirrors.g, sight.past_mirrors.b, sight.pdf};
    }
    HD Sight sight_of(uint32_t walk) const {
        const Float4 s = sights[walk];
        return {{s.x, s.y, s.z}, s.w};
    }
    /// Of a photon: the square of the refractive index of what it is in, over that of what its light stands in.
    HD float index_squared(uint32_t walk) const { return sights[walk].w; }
    HD void store_index(uint32_t walk, float squared) const { sights[walk] = {0, 0, 0, squared}; }
    HD void store(uint32_t at, const Lookup& lookup) const {
        const Hit& hit = lookup.hit;
        const Vec3 d = lookup.direction;
        const Rgb t = lookup.throughput;
        places[at] = {hit.u, hit.v, float_of(hit.instance), float_of(hit.primitive)};
        directions[at] = {d.x, d.y, d.z, float_of(lookup.scatterings << 1 | (lookup.wants_all ? 1u : 0u))};
        throughputs[at] = {t.r, t.g, t.b, float_of(lookup.pixel)};
    }
    HD Lookup load(uint32_t at) const {
        const Float4 p = places[at], d = directions[at], t = throughputs[at];
        const uint32_t bits = bits_of(d.w);
        return {{0, p.x, p.y, bits_of(p.z), bits_of(p.w)},
                {d.x, d.y, d.z},
                {t.x, t.y, t.z},
                bits_of(t.w),
                bits >> 1,
                (bits & 1) != 0};
    }
};

/// Places the arrays in one piece of memory (lay_out_arrays).
inline std::size_t lay_out(GatherView& view, std::byte* memory, const GatherRoom& room) {
    view.nearest_count = room.nearest;
    return lay_out_arrays(memory, [&](const auto& place) {
        const std::size_t walks = room.count, shared = room.can_share ? walks : 0;
        place(view.sights, walks);
        place(view.marks, walks);
        place(view.places, walks);
        place(view.directions, walks);
        place(view.throughputs, walks);
        place(view.nearest, walks * room.nearest);
        place(view.crowded, shared);
        place(view.shared_sums, shared);
    });
}

} // namespace pertev
