#pragma once

// Samples in flight, each of them a tree of rays that is walked depth first. A tree has one ray under way and a stack
// of those that wait, so that it takes a memory that is known beforehand however many rays it has. Each round traces
// the ray that every live tree has under way, through one queue of all; then each tree takes its next ray off its
// stack.
//
// One piece of memory holds all arrays, for the device and for a thread of the CPU alike.

#include <cstddef>
#include <cstdint>

#include "device_scene/accept_hit.h"
#include "device_scene/ray_queue.h"
#include "integrators/lay_out_arrays.h"
#include "math/float4.h"
#include "math/rgb.h"
#include "trace/intersect/ray.h"

namespace pertev {

/// Shadow rays that a vertex asks for at once; a vertex with more of them is looked at again.
inline constexpr uint32_t kShadowsAtOnce = 4;

/// A ray that waits, or that is under way.
struct PendingRay {
    Vec3 origin, direction; // unit direction
    Rgb weight = {1, 1, 1}; // of what it brings, in the sample
    float bsdf_pdf = 0;     // density with which `direction` was drawn, 1/sr; 0 where it is the only one there is
    uint32_t depth = 0;     // scatterings between it and the camera
    TriangleId start;       // triangle that it leaves
};

/// `contribution` counts if nothing stands between the ray's ends.
struct TreeShadowRay {
    Ray ray;
    TriangleId target; // the light's triangle
    Rgb contribution;  // to the sample
};

struct alignas(16) TreeState {
    Rgb radiance;           // gathered so far
    uint32_t pixel, sample; // that it is
    uint32_t pending;       // rays on the stack; the one under way is stored above them
    uint32_t rays;          // that have been under way: the present one has the number rays - 1
    uint32_t shadows;       // rays that the present vertex asked for last
};
static_assert(sizeof(TreeState) == 32);

/// Of one round.
struct TreeCounts {
    uint32_t rays;                 // under way
    uint32_t next;                 // that go on after it
    uint32_t shadows;              // asked for since the last look
    uint64_t bounces, all_shadows; // of all rounds
};

struct TreesView {
    uint32_t capacity; // trees
    TreeState* states; // [capacity]

    // The stacks, entry k of tree i at k * capacity + i.
    Float4* origins;      // origin, bits of the depth
    Float4* directions;   // direction, bsdf_pdf
    Float4* weights;      // weight, bits of the start's instance
    uint32_t* primitives; // of the start

    // The rays under way, side by side. Rounds read and write their owners, the trees, in two arrays in turns.
    Ray* rays;
    Uint2* starts;
    uint32_t* keys; // of coins
    float* times;   // RayQueueView's; null unless something moves while the shutter is open
    uint32_t* owners[2];
    Float4* hit_places;
    uint32_t* hit_instances;

    // Shadow rays, [kShadowsAtOnce * capacity].
    Ray* shadow_rays;
    Uint2 *shadow_starts, *shadow_targets;
    uint32_t* shadow_keys; // then what the ray met
    float* shadow_times;
    Float4* contributions;
    Uint4* asked; // [capacity]: places of the shadow rays of a tree

    TreeCounts* counts;

    RayQueueView query() const { return {.rays = rays, .starts = starts, .keys = keys, .times = times}; }
    RayQueueView shadow_query() const {
        return {.rays = shadow_rays,
                .starts = shadow_starts,
                .targets = shadow_targets,
                .keys = shadow_keys,
                .times = shadow_times};
    }
    HD HitQueueView hits() const { return {hit_places, hit_instances}; }

    HD std::size_t entry(uint32_t tree, uint32_t place) const { return std::size_t(place) * capacity + tree; }
    HD PendingRay load_ray(uint32_t tree, uint32_t place) const {
        const std::size_t at = entry(tree, place);
        const Float4 o = origins[at], d = directions[at], w = weights[at];
        PendingRay ray;
        ray.origin = {o.x, o.y, o.z};
        ray.depth = bits_of(o.w);
        ray.direction = {d.x, d.y, d.z};
        ray.bsdf_pdf = d.w;
        ray.weight = {w.x, w.y, w.z};
        ray.start = {bits_of(w.w), primitives[at]};
        return ray;
    }
    HD void store_ray(uint32_t tree, uint32_t place, const PendingRay& ray) const {
        const std::size_t at = entry(tree, place);
        origins[at] = {ray.origin.x, ray.origin.y, ray.origin.z, float_of(ray.depth)};
        directions[at] = {ray.direction.x, ray.direction.y, ray.direction.z, ray.bsdf_pdf};
        weights[at] = {ray.weight.r, ray.weight.g, ray.weight.b, float_of(ray.start.instance)};
        primitives[at] = ray.start.primitive;
    }
    /// Puts `ray` of `tree` at `place` of the queue of those under way. `key`: its coin's; `time`: of all rays of the
    /// tree.
    HD void queue_ray(uint32_t place, uint32_t tree, const PendingRay& ray, uint32_t key, float time,
                      uint32_t round) const {
        pertev::store_ray(rays + place, {ray.origin, 0.0f, ray.direction, kInfinity});
        starts[place] = {ray.start.instance, ray.start.primitive};
        keys[place] = key;
        if (times != nullptr) times[place] = time;
        owners[round % 2][place] = tree;
    }
    HD void queue_shadow(uint32_t place, const TreeShadowRay& shadow, TriangleId start, uint32_t key,
                         float time) const {
        pertev::store_ray(shadow_rays + place, shadow.ray);
        shadow_starts[place] = {start.instance, start.primitive};
        shadow_targets[place] = {shadow.target.instance, shadow.target.primitive};
        shadow_keys[place] = key;
        if (shadow_times != nullptr) shadow_times[place] = time;
        contributions[place] = {shadow.contribution.r, shadow.contribution.g, shadow.contribution.b, 0};
    }
};

/// The sizes of the arrays.
struct TreeRoom {
    uint32_t count;   // trees
    uint32_t entries; // rays of a stack
    bool has_times;   // rays have a time
};

/// Places the arrays in one piece of memory (lay_out_arrays).
inline std::size_t lay_out(TreesView& view, std::byte* memory, const TreeRoom& room) {
    view.capacity = room.count;
    return lay_out_arrays(memory, [&](const auto& place) {
        const std::size_t trees = room.count, stacked = trees * room.entries, shadows = trees * kShadowsAtOnce;
        place(view.states, trees);
        place(view.origins, stacked);
        place(view.directions, stacked);
        place(view.weights, stacked);
        place(view.primitives, stacked);
        place(view.rays, trees);
        place(view.starts, trees);
        place(view.keys, trees);
        place(view.times, room.has_times ? trees : 0);
        place(view.owners[0], trees);
        place(view.owners[1], trees);
        place(view.hit_places, trees);
        place(view.hit_instances, trees);
        place(view.shadow_rays, shadows);
        place(view.shadow_starts, shadows);
        place(view.shadow_targets, shadows);
        place(view.shadow_keys, shadows);
        place(view.shadow_times, room.has_times ? shadows : 0);
        place(view.contributions, shadows);
        place(view.asked, trees);
        place(view.counts, 1);
    });
}

} // namespace pertev
