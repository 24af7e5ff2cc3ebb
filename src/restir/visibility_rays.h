#pragma once

// Queue of shadow rays between two points, in a tracer's layout, each with its pixel.

#include <cstdint>

#include "device/block_append.h"
#include "device_scene/accept_hit.h"
#include "device_scene/ray_queue.h"

namespace pertev {

struct VisibilityRaysView {
    Ray* rays;
    Uint2 *starts, *targets;
    uint32_t* keys;   // keys, and after tracing the results
    uint32_t* pixels; // pixel of each ray
    uint32_t* count;

    RayQueueView query() const { return {.rays = rays, .starts = starts, .targets = targets, .keys = keys}; }

    HD void store(uint32_t i, const Ray& ray, TriangleId start, TriangleId target, uint32_t key, uint32_t pixel) const {
        store_ray(rays + i, ray);
        starts[i] = {start.instance, start.primitive};
        targets[i] = {target.instance, target.primitive};
        keys[i] = key;
        pixels[i] = pixel;
    }
    HD bool is_free(uint32_t i) const { return keys[i] == kNoHit; }
};

} // namespace pertev
