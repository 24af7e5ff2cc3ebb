#pragma once

// Finds the first hit of a camera ray in its tile's list, with the same triangle test, acceptance rules and choice
// among candidates as tree traversal (trace/trace_closest.h), thus with the same bits.

#include "device_scene/accept_hit.h"
#include "device_scene/ray_queue.h"
#include "render/raster/tile_lists.h"
#include "trace/intersect/intersect_triangle.h"
#include "trace/scene_trees.h"
#include "trace/trace_closest.h"

namespace pertev {

/// A scene as a camera sees it, made by CameraRaster (render/raster/camera_raster.h).
struct TileRasterView {
    const BvhTriangle* triangles;
    const uint64_t* codes; // sorted codes of TileListsView
    const uint32_t* order; // [entry] index into `triangles`
    const Uint2* tiles;    // result of FinishTileLists
    uint32_t width, shift, tiles_x;

    HD Uint2 list_of(uint32_t pixel) const {
        const uint32_t row = pixel / width, column = pixel - row * width;
        return tiles[(row >> shift) * tiles_x + (column >> shift)];
    }
    HD float min_t(uint32_t entry) const { return float_of(static_cast<uint32_t>(codes[entry])); }
};

/// Finds the closest hit of `ray`, a camera ray of a sample of `pixel`; `key` is the ray's key for blended surfaces.
HD inline Hit find_in_tile(const TileRasterView& raster, const SceneView& scene, const Ray& ray, uint32_t pixel,
                           uint32_t key) {
    const AcceptCameraHit accept = {{scene, {}, {}, key}, ray.direction};
    ClosestVisitor<AcceptCameraHit> visitor = {accept, {}};
    visitor.best.t = ray.t_max;
    const Uint2 list = raster.list_of(pixel);
    const RayShear world_shear = make_ray_shear(ray.direction);
    Ray local = ray;
    RayShear local_shear = world_shear;
    uint32_t space = kNoHit; // the instance whose space `local` is in
    for (uint32_t i = list.x; i < list.y && raster.min_t(i) <= visitor.best.t; ++i) {
        const BvhTriangle triangle = load_aligned(raster.triangles + raster.order[i]);
        const bool is_baked = (triangle.flags & kIsBaked) != 0;
        if (!is_baked && space != triangle.instance) {
            space = triangle.instance;
            local = transform_ray(scene.instances[space].local_from_world, ray);
            local_shear = make_ray_shear(local.direction);
        }
        TriangleHit hit;
        if (intersect_triangle(is_baked ? ray.origin : local.origin, is_baked ? world_shear : local_shear, ray.t_min,
                               ray.t_max, triangle.a, triangle.b, triangle.c, hit)) {
            visitor.visit(triangle.instance, triangle.primitive, hit);
        }
    }
    return visitor.best;
}

/// The stage that finds the hits of queued camera rays. The rays are endless; t_min holds the pixel's index.
struct FindInTiles {
    TileRasterView raster;
    SceneView scene;
    RayQueueView rays;
    HitQueueView hits;

    HD void operator()(uint32_t i) const {
        const int64_t index = rays.index(i);
        Ray ray = load_ray(rays.rays + index);
        const uint32_t pixel = bits_of(ray.t_min);
        ray.t_min = 0;
        ray.t_max = kInfinity;
        hits.store(i, find_in_tile(raster, scene, ray, pixel, scene.any_alpha != 0 ? rays.keys[index] : 0));
    }
};

} // namespace pertev
