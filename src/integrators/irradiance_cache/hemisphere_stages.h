#pragma once

// Stages that make records: a path from each cell of a point's hemisphere, then the sum over the cells.

#include "integrators/irradiance_cache/cache_memory.h"
#include "integrators/irradiance_cache/irradiance_cache_settings.h"
#include "integrators/irradiance_cache/irradiance_record.h"
#include "integrators/irradiance_cache/lookup_stages.h"
#include "integrators/subpaths/subpath_vertex.h"
#include "math/frame.h"
#include "math/portable_inverse_trig.h"
#include "math/portable_trig.h"
#include "math/rgb.h"
#include "math/vec2.h"

namespace pertev {

// A record results from the rays of its hemisphere: the light, its rotational and translational gradients, and the
// distance to the surroundings. The light comes from a function of the cell, so tests can compare it with closed
// forms.
//
// Sources: Ward, Heckbert, "Irradiance Gradients", EGWR 1992, section 3 (the gradients; the mean of the tangent over
// a row is in closed form here); Ward et al. 1988 (the harmonic mean of distances). The rotational gradient is stored
// as the vector g of dE = g (n' - n).

/// Direction in cell `cell` (row by row) at `u` in its unit square; unit, around +z.
HD inline Vec3 direction_in_cell(const HemisphereGrid& grid, uint32_t cell, Vec2 u) {
    const float sine_squared = (static_cast<float>(cell / grid.columns) + u.x) / static_cast<float>(grid.rows);
    const float turns = (static_cast<float>(cell % grid.columns) + u.y) / static_cast<float>(grid.columns);
    float sine, cosine;
    sin_cos_2pi(turns, sine, cosine);
    const float radius = sqrt(sine_squared);
    return {radius * cosine, radius * sine, safe_sqrt(1.0f - sine_squared)};
}

struct HemisphereCell {
    Rgb light;      // radiance, W/(sr m2)
    float distance; // metres; may be infinite
};

/// Sum over a hemisphere; see IrradianceRecord.
struct HemisphereSum {
    Rgb light;
    Vec3 by_turn[3], by_move[3];
    float radius; // harmonic mean of the distances; infinite if nothing is hit
};

namespace hemisphere {

/// Integral of tan from the normal to the angle with squared sine `s`, over the cosine-weighted hemisphere.
HD inline float tangents_to(float s) { return asin(sqrt(s)) - sqrt(s * (1.0f - s)); }

HD inline void add(Vec3 (&sums)[3], Rgb light, Vec3 direction) {
    sums[0] += light.r * direction;
    sums[1] += light.g * direction;
    sums[2] += light.b * direction;
}

} // namespace hemisphere

/// Sums a hemisphere. `cell_of(cell)` returns its HemisphereCell. The tangent and bitangent of `frame` are x and y of
/// direction_in_cell.
template <class CellOf>
HD inline HemisphereSum sum_hemisphere(const HemisphereGrid& grid, const Frame& frame, const CellOf& cell_of) {
    const float rows = static_cast<float>(grid.rows), columns = static_cast<float>(grid.columns);
    HemisphereSum sum = {};
    float nearness = 0; // sum of 1 / distance
    for (uint32_t row = 0; row < grid.rows; ++row) {
        const float from = static_cast<float>(row) / rows, to = static_cast<float>(row + 1) / rows;
        const float tangent = rows * (hemisphere::tangents_to(to) - hemisphere::tangents_to(from));
        const float across_row = 2.0f * sqrt(from) * (1.0f - from) / columns; // 2 pi / columns sin cos^2 over pi
        const float across_column = kInvPi * (sqrt(to) - sqrt(from));
        for (uint32_t column = 0; column < grid.columns; ++column) {
            const uint32_t cell = row * grid.columns + column;
            const HemisphereCell here = cell_of(cell);
            float sine, cosine;
            sin_cos_2pi((static_cast<float>(column) + 0.5f) / columns, sine, cosine);
            const Vec3 outwards = cosine * frame.tangent + sine * frame.bitangent;
            sum.light += here.light;
            nearness += 1.0f / here.distance;
            hemisphere::add(sum.by_turn, tangent * here.light, outwards);
            if (row > 0) {
                const HemisphereCell inner = cell_of(cell - grid.columns);
                const float change = across_row / min(here.distance, inner.distance);
                hemisphere::add(sum.by_move, change * (here.light - inner.light), outwards);
            }
            const HemisphereCell before = cell_of(column > 0 ? cell - 1 : cell + grid.columns - 1);
            sin_cos_2pi(static_cast<float>(column) / columns, sine, cosine);
            const Vec3 round = cosine * frame.bitangent - sine * frame.tangent; // at the border between two columns
            const float change = across_column / min(here.distance, before.distance);
            hemisphere::add(sum.by_move, change * (here.light - before.light), round);
        }
    }
    const float share = 1.0f / (rows * columns);
    sum.light = share * sum.light;
    for (Vec3& gradient : sum.by_turn) gradient = share * gradient;
    sum.radius = 1.0f / (share * nearness);
    return sum;
}

/// Limits the radius of a record, in metres, to [least, most] and to where its light would change by its own value
/// (Ward and Heckbert 1992, section 4). If `least` exceeds that, the gradient is reduced accordingly.
HD inline void limit_radius(HemisphereSum& sum, float least, float most) {
    const Vec3 gradient = 0.2126f * sum.by_move[0] + 0.7152f * sum.by_move[1] + 0.0722f * sum.by_move[2];
    const float change = length(gradient), light = luminance(sum.light);
    if (sum.radius * change > light) sum.radius = light / change;
    if (sum.radius < least) {
        for (Vec3& g : sum.by_move) g = (sum.radius / least) * g;
    }
    sum.radius = clamp(sum.radius, least, most);
}

/// Records of a picture that are being made.
struct HemisphereJob {
    const RecordSite* sites; // sites of these records
    uint32_t first_record;   // index of the first one in the picture
    uint32_t begin;          // the first record whose cells are in memory
    HemisphereGrid grid;
};

HD inline Hit hit_of(const RecordSite& site) { return {0, site.u, site.v, site.instance, site.primitive}; }

/// The stage that starts paths 0, 1, ... for the cells `first`, first + 1, ... in memory.
template <ShadingVariant kVariant>
struct BeginHemispheres {
    SubpathScene scene;
    SubpathsView subpaths;
    CacheSubpathsView cache;
    HemisphereJob job;
    uint32_t first;

    HD INLINE_ON_DEVICE void operator()(uint32_t i) const {
        const uint32_t at = first + i, cells = job.grid.cells();
        const uint32_t number = job.begin + at / cells, cell = at % cells;
        cache.cells[at] = {0, 0, 0, kInfinity};
        const RecordSite site = job.sites[number];
        const Surface surface = make_surface<kVariant>(scene.picture.scene, hit_of(site), site.direction);
        const float side = CachedSurface(surface, -site.direction).side;
        SubpathState state = {};
        state.pixel = job.first_record + number;
        state.sample = cell;
        state.scatterings = static_cast<uint16_t>(site.scatterings + 1);
        const SampleKey key = {state.pixel, state.sample, scene.settings.seed};
        Vec3 local = direction_in_cell(job.grid, cell, sample_2d(SamplerKind::Independent, key, kGroupCamera));
        local.z = side * local.z;
        state.throughput = grey(coating_transmittance(surface.bsdf, side, local));
        if (surface.tilt > 0) local = raise_direction(local, surface.tilt).direction;
        const Vec3 wi = normalize(surface.frame.to_world(local));
        const bool is_before = (dot(surface.geometric_normal, wi) > 0) == (side > 0);
        if (!is_before || is_black(state.throughput)) return;
        subpaths.states[i] = state;
        // A record contains neither directly visible or mirrored emitters, nor emitters that later bounces see in
        // mirrors.
        cache.store_cache_state(i, {{0, 0, 0}, 0});
        cache.store_path(i, {0, 0, 0});
        cache.distances[i] = 0;
        cache.aims[i] = SubpathAim::GoOn;
        const Ray ray = {offset_ray_origin(surface.position, surface.error, surface.geometric_normal, wi), 0, wi,
                         kInfinity};
        subpaths.queue_ray(atomic_add(&subpaths.counts->next, 1u), i, ray, surface.triangle,
                           coin_key(key, site.scatterings, false), 0);
    }
};

/// The stage that stores the hit distance of ray i of a first round.
struct StoreDistances {
    SubpathsView subpaths;
    CacheSubpathsView cache;
    uint32_t first;

    HD void operator()(uint32_t i) const {
        const Hit hit = subpaths.hits().load(i);
        if (hit.instance != kNoHit) cache.cells[first + subpaths.owners[0][i]].w = hit.t;
    }
};

/// The stage that converts the sums of cell i in memory to floats.
struct ReadCells {
    CacheSubpathsView cache;

    HD void operator()(uint32_t i) const {
        const FixedSum* light = cache.light + 3 * std::size_t(i);
        const float distance = cache.cells[i].w;
        cache.cells[i] = {mean_of(light[0], 1), mean_of(light[1], 1), mean_of(light[2], 1), distance};
    }
};

/// Limits of a record's radius in pixels (Tabellion and Lamorlette 2004, section 4.2).
inline constexpr float kMinPixels = 16, kMaxPixels = 400;

/// The stage that finishes record i of those whose cells are in memory.
template <ShadingVariant kVariant>
struct FinishRecords {
    SubpathScene scene;
    CacheSubpathsView cache;
    HemisphereJob job;
    IrradianceRecord* records; // records of the picture

    HD INLINE_ON_DEVICE void operator()(uint32_t i) const {
        const RecordSite site = job.sites[job.begin + i];
        const Surface surface = make_surface<kVariant>(scene.picture.scene, hit_of(site), site.direction);
        const float side = CachedSurface(surface, -site.direction).side;
        const float pixel = pixel_size(scene.picture.camera.view, site.distance);
        const std::size_t first = std::size_t(i) * job.grid.cells();
        const float nearest = 0x1p-6f * pixel; // smaller distances count as this
        HemisphereSum sum = sum_hemisphere(job.grid, surface.frame, [&](uint32_t cell) {
            const Float4 c = cache.cells[first + cell];
            return HemisphereCell{{c.x, c.y, c.z}, max(c.w, nearest)};
        });
        limit_radius(sum, kMinPixels * pixel, kMaxPixels * pixel);
        IrradianceRecord record;
        record.point = cache_point(surface, side, site.scatterings);
        record.radius = sum.radius;
        record.light = sum.light;
        for (int k = 0; k < 3; ++k) {
            record.by_turn[k] = sum.by_turn[k];
            record.by_move[k] = sum.by_move[k];
        }
        records[job.first_record + job.begin + i] = record;
    }
};

} // namespace pertev
