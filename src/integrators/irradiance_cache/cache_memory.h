#pragma once

// What walks of irradiance caching know beside subpaths/walk_memory.h, and the cells of hemispheres in flight.

#include <cstddef>
#include <cstdint>

#include "integrators/subpaths/walk_memory.h"
#include "render/fixed_sum.h"

namespace pertev {

/// What a walk is after.
enum class WalkAim : uint32_t {
    Seek, // a diffuse surface, past mirrors and smooth glass alone, to look light up there
    GoOn, // all light that a path finds
    End,  // nothing any more
};

/// Beside the walk's throughput, which counts for light that its next surface sends on.
struct CacheSight {
    Rgb seen;  // counts for light that the ray itself runs into
    float pdf; // with which its direction was drawn, 1/sr; 0 after the camera or a delta lobe
};

/// Whether lamps may be seen by mirrors and smooth glass in the scene, which takes some of both.
struct MirroredLamps {
    uint64_t mirrors, lamps; // instances; where there is an environment, all count as lamps

    HD bool are_possible() const { return mirrors > 0 && lamps > 0; }
};

/// A diffuse surface where light is to be looked up.
struct CacheLookup {
    Hit hit;
    Vec3 direction; // of the walk, unit
    float way;      // from the camera, metres
    Rgb throughput;
    uint32_t walk, scatterings;
};

struct CacheWalksView {
    Float4* sights; // [walks]
    Float4* paths;  // [walks] throughput of all light, as path tracing has it; 0 of a record's rays
    float* ways;    // [walks] from the camera, metres
    WalkAim* aims;  // [walks]
    // Lookups of a round, side by side; WalkCounts::vertices is their number.
    Float4 *places, *directions, *throughputs;
    uint32_t* scatterings;
    // Cells of hemispheres.
    FixedSum* light; // [3 * cells]
    Float4* cells;   // [cells] light as floats, W/(sr m2); metres to what the first ray met

    HD void store_sight(uint32_t walk, const CacheSight& sight) const {
        sights[walk] = {sight.seen.r, sight.seen.g, sight.seen.b, sight.pdf};
    }
    HD CacheSight sight_of(uint32_t walk) const {
        const Float4 s = sights[walk];
        return {{s.x, s.y, s.z}, s.w};
    }
    HD void store_path(uint32_t walk, Rgb throughput) const {
        paths[walk] = {throughput.r, throughput.g, throughput.b, 0};
    }
    HD Rgb path_of(uint32_t walk) const { return {paths[walk].x, paths[walk].y, paths[walk].z}; }
    HD void store(uint32_t at, const CacheLookup& lookup) const {
        const Hit& hit = lookup.hit;
        const Vec3 d = lookup.direction;
        const Rgb t = lookup.throughput;
        places[at] = {hit.u, hit.v, float_of(hit.instance), float_of(hit.primitive)};
        directions[at] = {d.x, d.y, d.z, lookup.way};
        throughputs[at] = {t.r, t.g, t.b, float_of(lookup.walk)};
        scatterings[at] = lookup.scatterings;
    }
    HD CacheLookup load(uint32_t at) const {
        const Float4 p = places[at], d = directions[at], t = throughputs[at];
        return {{0, p.x, p.y, bits_of(p.z), bits_of(p.w)},
                {d.x, d.y, d.z},
                d.w,
                {t.x, t.y, t.z},
                bits_of(t.w),
                scatterings[at]};
    }
};

/// The sizes of the arrays.
struct CacheRoom {
    uint32_t count; // walks
    uint32_t cells; // of hemispheres
};

/// Places the arrays in one piece of memory (lay_out_arrays).
inline std::size_t lay_out(CacheWalksView& view, std::byte* memory, const CacheRoom& room) {
    return lay_out_arrays(memory, [&](const auto& place) {
        const std::size_t walks = room.count, cells = room.cells;
        place(view.sights, walks);
        place(view.paths, walks);
        place(view.ways, walks);
        place(view.aims, walks);
        place(view.places, walks);
        place(view.directions, walks);
        place(view.throughputs, walks);
        place(view.scatterings, walks);
        place(view.light, 3 * cells);
        place(view.cells, cells);
    });
}

} // namespace pertev
