#pragma once

// Data that paths of irradiance caching need besides subpaths/subpath_memory.h, and the cells of hemispheres in flight.

#include <cstddef>
#include <cstdint>

#include "integrators/subpaths/subpath_memory.h"
#include "render/fixed_sum.h"

namespace pertev {

/// Purpose of a path.
enum class SubpathAim : uint32_t {
    Seek, // find a diffuse surface through mirrors and smooth glass only, to look its light up
    GoOn, // find all light, as in path tracing
    End,  // nothing more
};

/// Data of a path besides its throughput, which counts for light that its next surface scatters.
struct CacheState {
    Rgb seen;  // factor for light that the ray itself hits
    float pdf; // density with which its direction was sampled, 1/sr; 0 after the camera or a delta lobe
};

/// Counts of emitters and of mirrors or smooth glass, in which emitters may be visible if there are both.
struct MirroredEmitters {
    uint64_t mirrors, emitters; // instances; with an environment, all count as emitters

    HD bool are_possible() const { return mirrors > 0 && emitters > 0; }
};

/// A diffuse surface whose light is looked up.
struct CacheLookup {
    Hit hit;
    Vec3 direction; // direction of the path, unit
    float distance; // distance from the camera along the path, metres
    Rgb throughput;
    uint32_t subpath, scatterings;
};

struct CacheSubpathsView {
    Float4* cache_states; // [paths]
    Float4* paths;        // [paths] throughput of all light, as in path tracing; 0 for rays of a record
    float* distances;     // [paths] distance from the camera, metres
    SubpathAim* aims;     // [paths]
    // Lookups of a round, contiguous; SubpathCounts::vertices is their number.
    Float4 *hits, *directions, *throughputs;
    uint32_t* scatterings;
    // Cells of hemispheres.
    FixedSum* light; // [3 * cells]
    Float4* cells;   // [cells] light as floats, W/(sr m2); metres to the first hit

    HD void store_cache_state(uint32_t subpath, const CacheState& cache_state) const {
        cache_states[subpath] = {cache_state.seen.r, cache_state.seen.g, cache_state.seen.b, cache_state.pdf};
    }
    HD CacheState cache_state_of(uint32_t subpath) const {
        const Float4 s = cache_states[subpath];
        return {{s.x, s.y, s.z}, s.w};
    }
    HD void store_path(uint32_t subpath, Rgb throughput) const {
        paths[subpath] = {throughput.r, throughput.g, throughput.b, 0};
    }
    HD Rgb path_of(uint32_t subpath) const { return {paths[subpath].x, paths[subpath].y, paths[subpath].z}; }
    HD void store(uint32_t at, const CacheLookup& lookup) const {
        const Hit& hit = lookup.hit;
        const Vec3 d = lookup.direction;
        const Rgb t = lookup.throughput;
        hits[at] = {hit.u, hit.v, float_of(hit.instance), float_of(hit.primitive)};
        directions[at] = {d.x, d.y, d.z, lookup.distance};
        throughputs[at] = {t.r, t.g, t.b, float_of(lookup.subpath)};
        scatterings[at] = lookup.scatterings;
    }
    HD CacheLookup load(uint32_t at) const {
        const Float4 p = hits[at], d = directions[at], t = throughputs[at];
        return {{0, p.x, p.y, bits_of(p.z), bits_of(p.w)},
                {d.x, d.y, d.z},
                d.w,
                {t.x, t.y, t.z},
                bits_of(t.w),
                scatterings[at]};
    }
};

/// The sizes of the arrays.
struct CacheCapacity {
    uint32_t count;           // paths
    uint32_t cells;           // cells of hemispheres
    bool has_normals = false; // lights are selected by a tree
};

/// Places the arrays in one piece of memory (lay_out_arrays).
inline std::size_t lay_out(CacheSubpathsView& view, std::byte* memory, const CacheCapacity& capacity) {
    return lay_out_arrays(memory, [&](const auto& add_array) {
        const std::size_t subpaths = capacity.count, cells = capacity.cells;
        add_array(view.cache_states, subpaths);
        add_array(view.paths, subpaths);
        add_array(view.distances, subpaths);
        add_array(view.aims, subpaths);
        add_array(view.hits, subpaths);
        add_array(view.directions, subpaths);
        add_array(view.throughputs, subpaths);
        add_array(view.scatterings, subpaths);
        add_array(view.light, 3 * cells);
        add_array(view.cells, cells);
    });
}

} // namespace pertev
