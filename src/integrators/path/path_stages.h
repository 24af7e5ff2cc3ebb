#pragma once

// The stages of a wavefront of paths, in the order in which path_integrator.cpp launches them. Each does for one index
// what the CPU's loop does in one line, through the same functions.

#include "integrators/path/generate_path.h"
#include "integrators/path/path_queues.h"
#include "integrators/path/shade_hit.h"
#include "render/tiled_pixel.h"
#include "trace/trace_any.h"
#include "trace/trace_closest.h"

namespace pertev {

template <class Accept>
HD inline Hit find_hit(const SceneView& scene, const PathState& path, const Accept& accept) {
    Hit hit;
    trace_closest(scene.bvh, Ray{path.origin, 0.0f, path.direction, kInfinity}, accept, hit);
    return hit;
}

HD inline Hit find_hit(const SceneView& scene, const PathState& path, uint32_t seed) {
    return find_hit(scene, path, AcceptHit{scene, path.start, {}, path_key(path, seed, false)});
}

/// Of a path's first ray, where scene.any_hidden_back is set.
HD inline Hit find_camera_hit(const SceneView& scene, const PathState& path, uint32_t seed) {
    const AcceptHit accept{scene, path.start, {}, path_key(path, seed, false)};
    return find_hit(scene, path, AcceptCameraHit{accept, path.direction});
}

HD inline bool is_occluded(const SceneView& scene, Vec3 origin, Vec3 direction, float t_max, TriangleId start,
                           TriangleId target, uint32_t key) {
    return trace_any(scene.bvh, Ray{origin, 0.0f, direction, t_max}, AcceptHit{scene, start, target, key});
}

struct GeneratePaths {
    CameraRays camera;
    PathSettings settings;
    uint32_t first_pixel, pixels; // of the batch, in tiled order
    uint32_t first_sample;
    PathQueueView paths;

    HD void operator()(uint32_t i) const {
        const uint32_t pixel = tiled_pixel(first_pixel + i % pixels, camera.width, camera.height);
        paths.store(i, generate_path(camera, settings, pixel, first_sample + i / pixels));
    }
};

struct FindHits {
    SceneView scene;
    uint32_t seed;
    PathQueueView paths;
    const uint32_t* active; // null: slot i
    HitQueueView hits;

    HD void operator()(uint32_t i) const {
        hits.store(i, find_hit(scene, paths.load(active != nullptr ? active[i] : i), seed));
    }
};

struct FindCameraHits {
    SceneView scene;
    uint32_t seed;
    PathQueueView paths;
    HitQueueView hits;

    HD void operator()(uint32_t i) const { hits.store(i, find_camera_hit(scene, paths.load(i), seed)); }
};

struct ShadeHits {
    PictureView picture;
    PathSettings settings;
    FilmView film;
    PathQueueView paths;
    const uint32_t* active;
    HitQueueView hits;
    SlotListView next;
    ShadowQueueView shadows;
    uint32_t* shadow_count;

    HD void operator()(uint32_t i) const {
        const uint32_t slot = active != nullptr ? active[i] : i;
        PathState path = paths.load(slot);
        const Hit hit = hits.load(i);
        const uint32_t key = path_key(path, settings.seed, true);
        const TriangleId here = {hit.instance, hit.primitive};
        ShadowRay shadow;
        bool wants_shadow = false;
        const bool goes_on = shade_hit(picture, settings, film, path, hit, shadow, wants_shadow);
        if (goes_on) {
            paths.store(slot, path);
            next.push(slot);
        } else {
            paths.store_radiance(slot, path.radiance);
        }
        if (wants_shadow) shadows.store(atomic_add(shadow_count, 1u), shadow, slot, here, key);
    }
};

struct TraceShadows {
    SceneView scene;
    ShadowQueueView shadows;
    PathQueueView paths;

    HD void operator()(uint32_t i) const {
        const Float4 o = shadows.origin[i], d = shadows.direction[i], c = shadows.contribution[i];
        const Uint4 id = shadows.ids[i];
        if (is_occluded(scene, {o.x, o.y, o.z}, {d.x, d.y, d.z}, o.w, {id.x, id.y}, {bits_of(c.w), id.z}, id.w)) return;
        const uint32_t slot = bits_of(d.w);
        paths.store_radiance(slot, paths.load_radiance(slot) + Rgb{c.x, c.y, c.z});
    }
};

struct AddToFilm {
    FilmView film;
    PathQueueView paths;

    HD void operator()(uint32_t slot) const { add_radiance(film, paths.ids[slot].x, paths.load_radiance(slot)); }
};

} // namespace pertev
