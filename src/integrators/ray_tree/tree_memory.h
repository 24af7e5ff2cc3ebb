#pragma once

// Samples in flight, each a ray tree that is evaluated depth first. A tree has one current ray and a stack of pending
// rays, so its memory is known in advance however many rays it has. Each round traces the current ray of every live
// tree, through one queue; then each tree pops its next ray.
//
// One allocation holds all arrays, for the device as for a CPU thread.

#include <cstddef>
#include <cstdint>

#include "device_scene/accept_hit.h"
#include "device_scene/ray_queue.h"
#include "integrators/lay_out_arrays.h"
#include "math/float4.h"
#include "math/rgb.h"
#include "trace/intersect/ray.h"

namespace pertev {

/// Maximum number of shadow rays that a vertex requests at once; a vertex with more is shaded repeatedly.
inline constexpr uint32_t kShadowsAtOnce = 4;

/// A pending or current ray.
struct PendingRay {
    Vec3 origin, direction;  // unit direction
    Rgb weight = {1, 1, 1};  // factor of its radiance in the sample
    float bsdf_pdf = 0;      // density with which `direction` was sampled, 1/sr; 0 if it is the only possible
                             // direction
    uint32_t depth = 0;      // scatterings between it and the camera
    TriangleId start;        // triangle that it leaves
    InteriorList interior;   // nested solids that hold it, if any are nested
    Vec3 normal = {0, 0, 0}; // normal of the context that selected a light where it starts, if a tree did
};

/// A shadow ray; `contribution` counts if it is unoccluded.
struct TreeShadowRay {
    Ray ray;
    TriangleId target; // the light's triangle
    Rgb contribution;  // added to the sample
};

struct alignas(16) TreeState {
    Rgb radiance;           // sum so far
    uint32_t pixel, sample; // the sample that the tree renders
    uint32_t pending;       // rays on the stack; the current one is stored above them
    uint32_t rays;          // rays traced so far; the current one has the number rays - 1
    uint32_t shadows;       // shadow rays of the vertex's last request
};
static_assert(sizeof(TreeState) == 32);

/// Counts of one round.
struct TreeCounts {
    uint32_t rays;                 // current rays
    uint32_t next;                 // rays that continue after the round
    uint32_t shadows;              // shadow rays since the last count
    uint64_t bounces, all_shadows; // totals of all rounds
};

struct TreesView {
    uint32_t capacity; // trees
    TreeState* states; // [capacity]

    // The stacks; entry k of tree i is at k * capacity + i.
    Float4* origins;      // origin, bits of the depth
    Float4* directions;   // direction, bsdf_pdf
    Float4* weights;      // weight, bits of the start's instance
    uint32_t* primitives; // primitive of the start
    Uint2* interiors;     // null unless solids are nested
    Vec3* normals;        // null unless lights are selected by a tree

    // The current rays, contiguous. Rounds alternate between two arrays for their owners, the trees.
    Ray* rays;
    Uint2* starts;
    uint32_t* keys; // keys of coins
    float* times;   // the times of RayQueueView; null unless something moves while the shutter is open
    uint32_t* owners[2];
    Float4* hit_records;
    uint32_t* hit_instances;

    // Shadow rays, [kShadowsAtOnce * capacity].
    Ray* shadow_rays;
    Uint2 *shadow_starts, *shadow_targets;
    uint32_t* shadow_keys; // keys, and after tracing the results
    float* shadow_times;
    Float4* contributions;
    Uint4* shadow_slots; // [capacity]: slots of a tree's shadow rays

    TreeCounts* counts;

    RayQueueView query() const { return {.rays = rays, .starts = starts, .keys = keys, .times = times}; }
    RayQueueView shadow_query() const {
        return {.rays = shadow_rays,
                .starts = shadow_starts,
                .targets = shadow_targets,
                .keys = shadow_keys,
                .times = shadow_times};
    }
    HD HitQueueView hits() const { return {hit_records, hit_instances}; }

    HD std::size_t entry(uint32_t tree, uint32_t slot) const { return std::size_t(slot) * capacity + tree; }
    HD PendingRay load_ray(uint32_t tree, uint32_t slot) const {
        const std::size_t at = entry(tree, slot);
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
    HD void store_ray(uint32_t tree, uint32_t slot, const PendingRay& ray) const {
        const std::size_t at = entry(tree, slot);
        origins[at] = {ray.origin.x, ray.origin.y, ray.origin.z, float_of(ray.depth)};
        directions[at] = {ray.direction.x, ray.direction.y, ray.direction.z, ray.bsdf_pdf};
        weights[at] = {ray.weight.r, ray.weight.g, ray.weight.b, float_of(ray.start.instance)};
        primitives[at] = ray.start.primitive;
    }
    /// Loads the solids that hold the ray at `slot`. Only code for solids calls this: load_ray and store_ray leave
    /// solids and normals out.
    HD InteriorList load_interior(uint32_t tree, uint32_t slot) const {
        return interiors != nullptr ? InteriorList::of_words(interiors[entry(tree, slot)]) : InteriorList{};
    }
    HD void store_interior(uint32_t tree, uint32_t slot, InteriorList interior) const {
        if (interiors != nullptr) interiors[entry(tree, slot)] = interior.words();
    }
    HD void store_normal(uint32_t tree, uint32_t slot, Vec3 normal) const { normals[entry(tree, slot)] = normal; }
    HD Vec3 load_normal(uint32_t tree, uint32_t slot) const { return normals[entry(tree, slot)]; }
    /// Stores `ray` of `tree` at `slot` of the current rays. `key` is its key for blended surfaces, and `time` that of
    /// all rays of the tree.
    HD void queue_ray(uint32_t slot, uint32_t tree, const PendingRay& ray, uint32_t key, float time,
                      uint32_t round) const {
        pertev::store_ray(rays + slot, {ray.origin, 0.0f, ray.direction, kInfinity});
        starts[slot] = {ray.start.instance, ray.start.primitive};
        keys[slot] = key;
        if (times != nullptr) times[slot] = time;
        owners[round % 2][slot] = tree;
    }
    HD void queue_shadow(uint32_t slot, const TreeShadowRay& shadow, TriangleId start, uint32_t key, float time) const {
        pertev::store_ray(shadow_rays + slot, shadow.ray);
        shadow_starts[slot] = {start.instance, start.primitive};
        shadow_targets[slot] = {shadow.target.instance, shadow.target.primitive};
        shadow_keys[slot] = key;
        if (shadow_times != nullptr) shadow_times[slot] = time;
        contributions[slot] = {shadow.contribution.r, shadow.contribution.g, shadow.contribution.b, 0};
    }
};

/// The sizes of the arrays.
struct TreeCapacity {
    uint32_t count;     // trees
    uint32_t entries;   // rays per stack
    bool has_times;     // rays have a time
    bool has_interiors; // solids are nested
    bool has_normals;   // lights are selected by a tree
};

/// Places the arrays in one piece of memory (lay_out_arrays).
inline std::size_t lay_out(TreesView& view, std::byte* memory, const TreeCapacity& capacity) {
    view.capacity = capacity.count;
    return lay_out_arrays(memory, [&](const auto& add_array) {
        const std::size_t trees = capacity.count, stacked = trees * capacity.entries, shadows = trees * kShadowsAtOnce;
        add_array(view.states, trees);
        add_array(view.origins, stacked);
        add_array(view.directions, stacked);
        add_array(view.weights, stacked);
        add_array(view.primitives, stacked);
        add_array(view.interiors, capacity.has_interiors ? stacked : 0);
        add_array(view.normals, capacity.has_normals ? stacked : 0);
        add_array(view.rays, trees);
        add_array(view.starts, trees);
        add_array(view.keys, trees);
        add_array(view.times, capacity.has_times ? trees : 0);
        add_array(view.owners[0], trees);
        add_array(view.owners[1], trees);
        add_array(view.hit_records, trees);
        add_array(view.hit_instances, trees);
        add_array(view.shadow_rays, shadows);
        add_array(view.shadow_starts, shadows);
        add_array(view.shadow_targets, shadows);
        add_array(view.shadow_keys, shadows);
        add_array(view.shadow_times, capacity.has_times ? shadows : 0);
        add_array(view.contributions, shadows);
        add_array(view.shadow_slots, trees);
        add_array(view.counts, 1);
    });
}

} // namespace pertev
