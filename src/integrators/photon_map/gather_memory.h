#pragma once

// Data of photon-mapping subpaths besides subpaths/subpath_memory.h: what their next ray may add, and the lookups in
// the maps.

#include "accel/nearest_points.h"
#include "integrators/subpaths/subpath_memory.h"
#include "render/fixed_sum.h"

namespace pertev {

/// Data of a camera subpath besides its throughput.
struct GatherState {
    Rgb past_mirrors; // part of the throughput that applies to light behind mirrors and smooth glass only; the
                      // caustic map has the rest of that light
    float pdf;        // density with which the ray's direction was sampled, 1/sr; 0 after the camera or a delta lobe
};

/// A diffuse surface at which a subpath ends or continues.
struct Lookup {
    Hit hit;
    Vec3 direction; // direction of the subpath, unit
    Rgb throughput;
    uint32_t pixel, scatterings; // scatterings so far
    bool wants_all;              // looks up both maps, else only the caustic map
};

/// Light of photons from both maps that is scattered at a point, W/sr.
struct GatheredSums {
    FixedSum caustic[3], global[3];
};

/// Sizes of the arrays.
struct GatherCapacity {
    uint32_t count;             // subpaths
    uint32_t nearest;           // photons per subpath; 0: all within a radius count
    bool can_share;             // several threads may share a lookup
    bool has_interiors = false; // solids are nested in a scene with media
    bool has_normals = false;   // lights are selected by a tree
};

struct GatherView {
    Float4* gather_states; // [subpaths]; for a photon only index_squared
    uint32_t* marks; // [subpaths] for a photon 1 if other than delta lobes have scattered it; for a camera subpath
                     // whether it has continued at a diffuse surface
    // Lookups of a round, contiguous; SubpathCounts::vertices is their number.
    Float4 *hits, *directions, *throughputs;
    NearPoint* nearest; // [subpaths * nearest_count]
    uint32_t nearest_count;
    // Lookups of a round with many photons, which several threads share. SubpathCounts::crowded is their number.
    uint32_t* crowded = nullptr; // [subpaths] indices of lookups; null: none is shared
    GatheredSums* shared_sums;   // [subpaths]

    HD void store_gather_state(uint32_t subpath, const GatherState& gather_state) const {
        gather_states[subpath] = {gather_state.past_mirrors.r, gather_state.past_mirrors.g, gather_state.past_mirrors.b,
                                  gather_state.pdf};
    }
    HD GatherState gather_state_of(uint32_t subpath) const {
        const Float4 s = gather_states[subpath];
        return {{s.x, s.y, s.z}, s.w};
    }
    /// Square of the refractive index of a photon's medium, over that of its light's medium.
    HD float index_squared(uint32_t subpath) const { return gather_states[subpath].w; }
    HD void store_index(uint32_t subpath, float squared) const { gather_states[subpath] = {0, 0, 0, squared}; }
    HD void store(uint32_t at, const Lookup& lookup) const {
        const Hit& hit = lookup.hit;
        const Vec3 d = lookup.direction;
        const Rgb t = lookup.throughput;
        hits[at] = {hit.u, hit.v, float_of(hit.instance), float_of(hit.primitive)};
        directions[at] = {d.x, d.y, d.z, float_of(lookup.scatterings << 1 | (lookup.wants_all ? 1u : 0u))};
        throughputs[at] = {t.r, t.g, t.b, float_of(lookup.pixel)};
    }
    HD Lookup load(uint32_t at) const {
        const Float4 p = hits[at], d = directions[at], t = throughputs[at];
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
inline std::size_t lay_out(GatherView& view, std::byte* memory, const GatherCapacity& capacity) {
    view.nearest_count = capacity.nearest;
    return lay_out_arrays(memory, [&](const auto& add_array) {
        const std::size_t subpaths = capacity.count, shared = capacity.can_share ? subpaths : 0;
        add_array(view.gather_states, subpaths);
        add_array(view.marks, subpaths);
        add_array(view.hits, subpaths);
        add_array(view.directions, subpaths);
        add_array(view.throughputs, subpaths);
        add_array(view.nearest, subpaths * capacity.nearest);
        add_array(view.crowded, shared);
        add_array(view.shared_sums, shared);
    });
}

} // namespace pertev
