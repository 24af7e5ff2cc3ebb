#pragma once

// Lists of the triangles that rays of each tile of pixels can hit, nearest first. They are made once per scene and
// camera by passes over triangles, and every sample reads them (render/raster/find_in_tile.h).
//
// A triangle is added to the lists of all tiles that its bounds overlap, one row of tiles at a time, because a long
// triangle covers few tiles of each row. A triangle that spans many rows is deferred to a second pass, which balances
// the threads. Counters assign the positions, so the order before sorting is arbitrary. After it only triangles at
// equal depth may be swapped, and the first hit does not depend on their order.

#include <cstdint>

#include "accel/bvh/bvh.h"
#include "device/atomics.h"
#include "device_scene/scene_view.h"
#include "math/float4.h"
#include "render/raster/screen_bounds.h"

namespace pertev {

inline constexpr uint32_t kIsBaked = 2; // in BvhTriangle::flags: the triangle is in world space, else in its
                                        // instance's

struct TileCounts {
    uint64_t triangles; // visible triangles
    uint64_t entries;   // entries of all lists
    uint64_t rows;      // rows deferred to the second pass
};

/// Memory in which lists are made. Overflow is counted and dropped.
struct TileListsView {
    BvhTriangle* triangles;    // visible ones in the traversal's format, with their instance
    uint64_t* codes;           // sort key of entries: tile in the upper half; bits of the least possible t of a hit
    uint32_t* order;           // [i] is i
    uint32_t* entry_triangles; // index into `triangles`
    Uint2* rows;               // index into `triangles`, row of tiles
    TileCounts* counts;
    uint64_t max_triangles, max_entries, max_rows;
    uint32_t shift;   // tiles have 2^shift pixels a side
    uint32_t tiles_x; // tiles per row
};

/// Applies the float transform of an instance, exact up to rounding of a double.
HD inline DoubleVec3 transform_in_double(const Transform& m, Vec3 p) {
    const DoubleVec3 d = to_double(p), t = to_double(m.translation);
    return {dot(to_double(m.row0), d) + t.x, dot(to_double(m.row1), d) + t.y, dot(to_double(m.row2), d) + t.z};
}

/// Maximum absolute row sum of the linear part.
HD inline float row_norm(const Transform& m) { return max_component(transform_sizes(m, {1, 1, 1})); }

/// Instance of triangle number `triangle` of the scene.
HD inline uint32_t instance_of(const SceneView& scene, uint32_t triangle) {
    uint32_t lo = 0, hi = scene.instance_count; // finds the last instance whose first triangle is not beyond
    while (hi - lo > 1) {
        const uint32_t mid = lo + (hi - lo) / 2;
        (scene.first_triangle[mid] <= triangle ? lo : hi) = mid;
    }
    return lo;
}

struct BinTriangles {
    Pinhole camera;
    SceneView scene;
    TileListsView lists;

    /// Bins triangle `number` of the scene.
    HD void operator()(uint32_t number) const {
        const uint32_t instance = instance_of(scene, number);
        const InstanceView& placed = scene.instances[instance];
        if (placed.is_hidden != 0) return;
        const MeshView& mesh = scene.meshes[placed.mesh];
        BvhTriangle triangle;
        triangle.primitive = number - scene.first_triangle[instance];
        triangle.instance = instance;
        const TriangleIndices at = triangle_indices(mesh, triangle.primitive);
        triangle.a = mesh.positions[at.a], triangle.b = mesh.positions[at.b], triangle.c = mesh.positions[at.c];
        if (placed.is_baked != 0) {
            triangle.flags = kIsBaked;
            triangle.a = transform_point(placed.world_from_local, triangle.a);
            triangle.b = transform_point(placed.world_from_local, triangle.b);
            triangle.c = transform_point(placed.world_from_local, triangle.c);
        }
        const PinholeTriangle seen = see(camera, scene, triangle);
        ScreenBounds bounds;
        if (!screen_bounds(camera, seen, 0, camera.height - 1, bounds)) return;
        const uint64_t slot = atomic_add(&lists.counts->triangles, uint64_t(1));
        if (slot >= lists.max_triangles) return;
        lists.triangles[slot] = triangle;
        const auto from = static_cast<uint32_t>(bounds.top) >> lists.shift,
                   to = static_cast<uint32_t>(bounds.bottom) >> lists.shift;
        if (from == to) return add_row(lists, camera, static_cast<uint32_t>(slot), from, bounds);
        const uint64_t waiting = atomic_add(&lists.counts->rows, uint64_t(to - from + 1));
        if (waiting + (to - from) >= lists.max_rows) return;
        for (uint32_t row = from; row <= to; ++row) {
            lists.rows[waiting + (row - from)] = {static_cast<uint32_t>(slot), row};
        }
    }

    /// Triangle in camera space with its error bound (render/raster/screen_bounds.h): in world space 2^-18 (|o| + |p|),
    /// and for a ray in an instance's space with condition K, 2 K times that, as for the TLAS's boxes
    /// (accel/bvh/tlas.h).
    HD static PinholeTriangle see(const Pinhole& camera, const SceneView& scene, const BvhTriangle& triangle) {
        PinholeTriangle seen;
        const Vec3 corners[] = {triangle.a, triangle.b, triangle.c};
        float reach = 0, growth = 1;
        if ((triangle.flags & kIsBaked) != 0) {
            for (int i = 0; i < 3; ++i) {
                seen.corners[i] = camera.see(to_double(corners[i]));
                reach = max(reach, max_component(abs(corners[i])));
            }
        } else {
            const InstanceView& placed = scene.instances[triangle.instance];
            const Transform& m = placed.world_from_local;
            for (int i = 0; i < 3; ++i) {
                seen.corners[i] = camera.see(transform_in_double(m, corners[i]));
                reach = max(reach, max_component(transform_sizes(m, abs(corners[i])) + abs(m.translation)));
            }
            growth = 2 * row_norm(m) * row_norm(placed.local_from_world);
        }
        const double sizes = static_cast<double>(camera.origin_max) + static_cast<double>(reach);
        seen.error = camera.error_scale * 0x1p-18 * static_cast<double>(growth) * sizes;
        return seen;
    }

    /// Adds a triangle to the lists of its tiles in a row.
    HD static void add_row(const TileListsView& lists, const Pinhole& camera, uint32_t slot, uint32_t row,
                           const ScreenBounds& bounds) {
        const auto from = static_cast<uint32_t>(bounds.left) >> lists.shift,
                   to = static_cast<uint32_t>(bounds.right) >> lists.shift;
        const uint64_t first_entry = atomic_add(&lists.counts->entries, uint64_t(to - from + 1));
        if (first_entry + (to - from) >= lists.max_entries) return;
        const double min_t = max(bounds.depth * camera.distance_scale, 0.0);
        // The float below, because it is only compared with a ray's t.
        const float nearest = static_cast<float>(min_t * (1 - 0x1p-20));
        for (uint32_t tile = from; tile <= to; ++tile) {
            const uint64_t entry = first_entry + (tile - from);
            lists.codes[entry] = uint64_t(row * lists.tiles_x + tile) << 32 | bits_of(nearest);
            lists.order[entry] = static_cast<uint32_t>(entry);
            lists.entry_triangles[entry] = slot;
        }
    }
};

/// The stage of the second pass, which bins one row of tiles of a triangle that spans several.
struct BinRows {
    Pinhole camera;
    SceneView scene;
    TileListsView lists;

    HD void operator()(uint32_t i) const {
        const Uint2 at = lists.rows[i];
        const uint32_t top = at.y << lists.shift, bottom = min(camera.height, (at.y + 1) << lists.shift) - 1;
        ScreenBounds bounds;
        const PinholeTriangle seen = BinTriangles::see(camera, scene, lists.triangles[at.x]);
        if (screen_bounds(camera, seen, top, bottom, bounds)) {
            BinTriangles::add_row(lists, camera, at.x, at.y, bounds);
        }
    }
};

/// The stage that finishes the lists after sorting, with one call per entry.
struct FinishTileLists {
    const uint64_t* codes; // sorted
    const uint32_t* entry_triangles;
    uint32_t* order; // index of the entry before sorting; becomes its triangle's index
    Uint2* tiles;    // first entry of each tile's list, and one past its last; zero before
    uint32_t count;

    HD void operator()(uint32_t i) const {
        order[i] = entry_triangles[order[i]];
        const auto tile = static_cast<uint32_t>(codes[i] >> 32);
        if (i == 0 || static_cast<uint32_t>(codes[i - 1] >> 32) != tile) tiles[tile].x = i;
        if (i + 1 == count || static_cast<uint32_t>(codes[i + 1] >> 32) != tile) tiles[tile].y = i + 1;
    }
};

} // namespace pertev
