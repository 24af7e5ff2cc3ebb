#pragma once

// Photons that a pass has stored on diffuse surfaces, the hash grid over them, and both maps in device code.

#include <cstddef>
#include <cstdint>

#include "accel/kd_tree/point_kd_tree.h"
#include "accel/nearest_points.h"
#include "accel/octree/point_octree.h"
#include "device/atomics.h"
#include "device_scene/accept_hit.h"
#include "integrators/photon_map/photon_map_settings.h"
#include "math/float4.h"
#include "math/random.h"
#include "math/rgb.h"
#include "math/scalar.h"
#include "math/vec3.h"

namespace pertev {

struct Photon {
    Vec3 position; // translated world, metres
    Vec3 wi;       // unit, towards its origin
    Vec3 normal;   // unit, of the triangle, on the side from which it came
    Rgb power;     // W, for the total power of all lights in a pass, divided by the square of the refractive index
                   // there and by the chance to meet the surface
    uint32_t path, scatterings;
    uint32_t owner; // result of owner_of
};

/// Identifies surfaces that paths meet by the same chance, by material and layer; 0 for those that paths surely meet.
/// A lookup counts only photons of its own owner. Where there is chance, their power is divided by it, because the
/// lookup itself is met by the same chance.
HD inline uint32_t owner_of(const SceneView& scene, uint32_t instance) {
    if (!has_stochastic_hits(scene, instance)) return 0;
    const InstanceView& placed = scene.instances[instance];
    return (hash_words(placed.material, placed.layers_above, 0).x & 0x7fffffu) + 1;
}

/// Packs the components with 10 bits each.
HD inline uint32_t pack_normal(Vec3 normal) {
    const auto part = [](float x) { return static_cast<uint32_t>(to_int((x + 1.0f) * 511.5f, 0, 1023)); };
    return part(normal.x) << 20 | part(normal.y) << 10 | part(normal.z);
}
HD inline Vec3 unpack_normal(uint32_t bits) {
    const auto part = [](uint32_t x) { return static_cast<float>(x & 1023u) * (1.0f / 511.5f) - 1.0f; };
    return {part(bits >> 20), part(bits >> 10), part(bits)};
}

/// Sort key of a photon: its order is (path, scatterings).
HD inline uint64_t photon_key(uint32_t path, uint32_t scatterings) { return uint64_t(path) << 8 | scatterings; }
inline constexpr uint64_t kKeyInMedium = uint64_t(1) << 33; // photons in media come last
inline constexpr int kKeyBits = 34;
static_assert((uint64_t(2 * kMaxPhotons) << 8) <= kKeyInMedium && kMaxPhotonDepth < 1 << 8);

struct PhotonsView {
    // Position, with 1 in a map, or 0 if it was removed (order_photons.h); wi, bits of the normal, or the medium;
    // power, bits of the owner and the scatterings.
    Float4 *positions, *directions, *powers;

    HD void store(std::size_t at, const Photon& photon, uint32_t normal_or_medium) const {
        const Vec3 p = photon.position, wi = photon.wi;
        positions[at] = {p.x, p.y, p.z, 0};
        directions[at] = {wi.x, wi.y, wi.z, float_of(normal_or_medium)};
        powers[at] = {photon.power.r, photon.power.g, photon.power.b, float_of(photon.owner << 8 | photon.scatterings)};
    }
    HD static uint32_t owner(Float4 power) { return bits_of(power.w) >> 8; }
    HD static uint32_t scatterings(Float4 power) { return bits_of(power.w) & 0xffu; }
    HD PhotonsView from(uint32_t first) const { return {positions + first, directions + first, powers + first}; }
};

struct PhotonCounts {
    uint32_t stored, caustic; // in all maps; in the caustic map
    uint32_t in_media;        // in the map of medium_photons.h
};

/// Photons as they are stored, in arbitrary order.
struct StoredPhotonsView {
    PhotonsView photons;
    uint64_t* keys; // result of photon_key
    PhotonCounts* counts;

    HD void add(const Photon& photon, bool is_caustic) const {
        const uint32_t at = atomic_add(&counts->stored, 1u);
        if (is_caustic) atomic_add(&counts->caustic, 1u);
        photons.store(at, photon, pack_normal(photon.normal));
        keys[at] = photon_key(photon.path, photon.scatterings);
    }
    /// Adds a photon that `medium` has scattered. Its normal does not count.
    HD void add_in_medium(const Photon& photon, uint32_t medium) const {
        const uint32_t at = atomic_add(&counts->stored, 1u);
        atomic_add(&counts->in_media, 1u);
        photons.store(at, photon, medium);
        keys[at] = kKeyInMedium | photon_key(photon.path, photon.scatterings);
    }
};

/// Cells of the grid, with a margin because positions are rounded by up to 2^-24 of the largest coordinate.
struct PhotonCells {
    float reach;      // metres around a point, more than the radius
    float per_metre;  // inverse of a cell's side
    uint32_t buckets; // a power of two

    HD int cell(float x) const { return to_int(floor(x * per_metre), -(1 << 30), 1 << 30); }
    HD uint32_t bucket(int x, int y, int z) const {
        return hash_words(static_cast<uint32_t>(x), static_cast<uint32_t>(y), static_cast<uint32_t>(z)).x &
               (buckets - 1);
    }
    HD uint32_t bucket_of(Vec3 p) const { return bucket(cell(p.x), cell(p.y), cell(p.z)); }
};

/// Makes the cells. `largest` is the largest |coordinate| of any photon and lookup. A lookup touches at most two
/// cells per axis: a side is more than twice the reach, and x * per_metre is rounded by less than the hundredth of a
/// cell that is left.
inline PhotonCells make_photon_cells(float radius, float largest, uint32_t count) {
    const float side = 2.05f * radius + 0x1p-17f * largest;
    uint32_t buckets = 1;
    while (buckets < count && buckets < 1u << 30) buckets *= 2;
    return {1.0001f * radius + 0x1p-20f * largest, min(1.0f / side, 0x1p100f), buckets};
}

struct PhotonGridView {
    PhotonCells cells;
    const Float4* points = nullptr;   // ordered by bucket: position, bits of the photon's number
    const uint32_t* starts = nullptr; // [buckets + 1] start in `points`
    uint32_t max_kept = 0xffffffffu;  // number of points of a bucket that are used, the first ones
};

/// Calls visit(begin, end) for each bucket, a range of grid.points, that may contain a photon near `at`.
template <class Visit>
HD inline void visit_buckets(const PhotonGridView& grid, Vec3 at, Visit&& visit) {
    const PhotonCells& cells = grid.cells;
    const auto low = [&](float x) { return cells.cell(x - cells.reach); };
    const int x0 = low(at.x), y0 = low(at.y), z0 = low(at.z);
    const int x_more = cells.cell(at.x + cells.reach) > x0 ? 1 : 0,
              y_more = cells.cell(at.y + cells.reach) > y0 ? 1 : 0,
              z_more = cells.cell(at.z + cells.reach) > z0 ? 1 : 0;
    uint32_t seen[8]; // two cells may share a bucket
    int seen_count = 0;
    for (int corner = 0; corner < 8; ++corner) {
        const int x = corner & 1, y = corner >> 1 & 1, z = corner >> 2;
        if (x > x_more || y > y_more || z > z_more) continue;
        const uint32_t bucket = cells.bucket(x0 + x, y0 + y, z0 + z);
        bool is_new = true;
        for (int k = 0; k < seen_count; ++k) is_new = is_new && seen[k] != bucket;
        if (!is_new) continue;
        seen[seen_count++] = bucket;
        const uint32_t begin = grid.starts[bucket];
        visit(begin, begin + min(grid.starts[bucket + 1] - begin, grid.max_kept));
    }
}

/// Upper bound of the photons that a search visits.
HD inline uint32_t count_near(const PhotonGridView& grid, Vec3 at) {
    uint32_t count = 0;
    visit_buckets(grid, at, [&](uint32_t begin, uint32_t end) { count += end - begin; });
    return count;
}

/// Share `number` of a search that is divided into `of` equal ones.
struct Share {
    uint32_t number = 0, of = 1;
};

/// Offers `found` each photon of a share that may be within its limit; see accel/nearest_points.h.
template <class Found>
HD inline void search_points(const PhotonGridView& grid, Vec3 at, Found& found, Share share = {}) {
    visit_buckets(grid, at, [&](uint32_t begin, uint32_t end) {
        for (uint32_t i = begin + share.number; i < end; i += share.of) {
            const Float4 point = grid.points[i];
            found.offer({squared_distance({point.x, point.y, point.z}, at), bits_of(point.w)});
        }
    });
}

struct PhotonMapView {
    PhotonsView photons; // in the order of (path, scatterings)
    uint32_t count = 0;  // includes removed ones
    float radius = 0;    // metres, of the current pass
    PhotonGridView grid;
    PointKdTreeView kd_tree;
    PointOctreeView octree;
};

/// Returns the map's structure for a kind of search.
template <PhotonSearch kSearch>
HD inline const auto& structure_of(const PhotonMapView& map) {
    if constexpr (kSearch == PhotonSearch::Grid) {
        return map.grid;
    } else if constexpr (kSearch == PhotonSearch::KdTree) {
        return map.kd_tree;
    } else {
        return map.octree;
    }
}

} // namespace pertev
