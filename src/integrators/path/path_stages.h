#pragma once

// The stages of a wavefront of paths, in the order in which path_integrator.cpp launches them. Each does for one index
// what the CPU's loop does in one line, through the same functions.

#include "integrators/path/generate_path.h"
#include "integrators/path/path_queues.h"
#include "integrators/path/shade_hit.h"
#include "render/tiled_pixel.h"

namespace pertev {

struct GeneratePaths {
    CameraRays camera;
    PathSettings settings;
    uint32_t first_pixel, pixels; // of the batch, in tiled order
    uint32_t first_sample;
    bool any_alpha;
    PathQueueView paths;

    HD void operator()(uint32_t i) const {
        const uint32_t pixel = tiled_pixel(first_pixel + i % pixels, camera.width, camera.height);
        const PathState path = generate_path(camera, settings, pixel, first_sample + i / pixels);
        paths.store(i, path, settings.seed, any_alpha);
        paths.samples[i] = {path.pixel, path.sample};
    }
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
            paths.store(slot, path, settings.seed, picture.scene.any_alpha != 0);
            next.push(slot);
        } else {
            paths.radiance[slot] = {path.radiance.r, path.radiance.g, path.radiance.b, 0};
        }
        if (wants_shadow) shadows.store(atomic_add(shadow_count, 1u), shadow, slot, here, key);
    }
};

/// Light whose shadow ray met nothing.
struct AddLight {
    ShadowQueueView shadows;
    const uint32_t* occluded; // of a tracer: kNoHit where the ray met nothing
    PathQueueView paths;

    HD void operator()(uint32_t i) const {
        if (occluded[i] != kNoHit) return;
        const Float4 c = shadows.contribution[i];
        paths.add_radiance(bits_of(c.w), {c.x, c.y, c.z});
    }
};

struct AddToFilm {
    FilmView film;
    PathQueueView paths;

    HD void operator()(uint32_t slot) const { add_radiance(film, paths.samples[slot].x, paths.load_radiance(slot)); }
};

} // namespace pertev
