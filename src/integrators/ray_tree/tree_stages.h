#pragma once

// Stages of a round of trees, in order. They are launched one by one on a device; a CPU thread runs the same ones
// over a few trees of its own.

#include "device/atomics.h"
#include "device_scene/nested_solids.h"
#include "integrators/ray_tree/tree_vertex.h"
#include "render/begin_order.h"
#include "render/film_view.h"
#include "render/first_hit.h"

namespace pertev {

/// The stage that starts samples `first`, first + 1, ... of `samples` as trees 0, 1, ... with their camera rays.
struct BeginTrees {
    CameraRays camera;
    RayTreeSettings settings;
    TreesView trees;
    BeginOrder samples;
    uint64_t first;

    HD void operator()(uint32_t i) const {
        const PixelSample begun = samples.at(first + i);
        TreeState state = {};
        state.pixel = begun.pixel, state.sample = begun.sample;
        state.rays = 1;
        const SampleKey key = sample_key(settings, state.pixel, state.sample);
        const Ray line = camera.ray(state.pixel, settings.sampler, key);
        PendingRay ray;
        ray.origin = line.origin;
        ray.direction = line.direction;
        trees.states[i] = state;
        trees.store_ray(i, 0, ray);
        trees.store_interior(i, 0, camera.interior);
        trees.queue_ray(i, i, ray, tree_key(state, settings.seed, 0, false), camera.time(settings.sampler, key), 0);
    }
};

/// Follows a ray of a tree to a surface among nested solids, as paths do (integrators/path/path_vertex.h).
HD_CALL inline void reach_nested_solid(const SceneView& scene, PendingRay& ray, const Hit& hit, Surface& surface,
                                       float time) {
    if (!scene.nesting.is_there()) return;
    const bool enters = dot(ray.direction, surface.geometric_normal) < 0;
    ray.interior = solids_before(scene, ray.interior, hit.instance, enters);
    nest_surface(scene, ray.interior, surface);
    const Rgb passed = transmittance_to_surface(scene, ray.interior, ray.start, ray.direction, hit, time);
    ray.weight = ray.weight * passed;
}

/// The stage that shades hits of the current rays. The vertex's shadow rays from `first_shadow` on are queued, at most
/// kShadowsAtOnce; the stage runs again until all have been. The first run adds emission; the last one (`is_last`)
/// pushes the continuation rays on the stack, in place of the ray that ended there. `Choice` selects lights
/// (shading/light_set.h).
template <class Algorithm, ShadingVariant kVariant, class Choice = ChosenByPower>
struct ShadeTrees {
    static constexpr MotionVariant kMotion = Algorithm::kHasShutter ? MotionVariant::Perhaps : MotionVariant::None;
    PictureView picture;
    RayTreeSettings settings;
    FilmView film;
    TreesView trees;
    uint32_t round, first_shadow;
    bool is_last;

    HD void operator()(uint32_t i) const {
        const uint32_t tree = trees.owners[round % 2][i];
        TreeState state = trees.states[tree];
        state.shadows = 0;
        PendingRay ray = trees.load_ray(tree, state.pending);
        const Hit hit = trees.hits().load(i);
        if constexpr (Choice::kReadsNormal) {
            if (ray.bsdf_pdf > 0) ray.normal = trees.load_normal(tree, state.pending);
        }
        if constexpr (kVariant == ShadingVariant::General) {
            ray.interior = trees.load_interior(tree, state.pending);
            if (hit.instance != kNoHit && !picture.scene.nesting.is_there()) {
                ray.weight = ray.weight * transmittance_to_hit<kVariant>(picture.scene, ray.start, ray.direction, hit,
                                                                         time_in_code(state));
            }
        }
        if (hit.instance == kNoHit) {
            if (first_shadow == 0) add_background(state, ray);
        } else {
            shade(tree, state, ray, hit);
        }
        trees.states[tree] = state;
    }

private:
    HD float time_in_code(const TreeState& state) const {
        return kMotion != MotionVariant::None ? time_of(picture.camera, settings, state) : kAtRest;
    }
    HD void add_background(TreeState& state, const PendingRay& ray) const {
        const LightSetView& lights = picture.scene.lights;
        if (ray.depth == 0) add_no_first_hit(film, state.pixel, state.sample);
        if (!lights.has_environment() || (ray.depth == 0 && picture.hides_background(ray.origin))) return;
        const float light_pdf = ray.bsdf_pdf > 0 ? pdf_environment(lights, ray.origin, ray.direction) : 0.0f;
        add_emission(state, ray, environment_radiance(lights.environment, ray.direction), light_pdf);
    }
    /// Adds emission that a ray hit. `light_pdf` is the density with which light sampling at the ray's start samples
    /// its direction, 1/sr; 0 if it cannot.
    HD static void add_emission(TreeState& state, const PendingRay& ray, Rgb emission, float light_pdf) {
        const float weight = ray.bsdf_pdf > 0 && light_pdf > 0 ? power_heuristic(ray.bsdf_pdf, light_pdf) : 1.0f;
        state.radiance += ray.weight * (weight * emission);
    }
    HD void shade(uint32_t tree, TreeState& state, PendingRay& ray, const Hit& hit) const {
        const SceneView& scene = picture.scene;
        constexpr bool kMayMove = kMotion != MotionVariant::None;
        const float time = time_in_code(state);
        const bool moves = is_moving<kMotion>(scene);
        const MovedHit moved(scene, hit, time);
        Surface surface = make_surface<kVariant>(scene, hit, kMayMove ? moved.back(ray.direction) : ray.direction);
        if (kMayMove) moved.move(surface);
        if constexpr (kVariant == ShadingVariant::General) reach_nested_solid(picture.scene, ray, hit, surface, time);
        if (first_shadow == 0) {
            if (ray.depth == 0) {
                add_first_hit(film, state.pixel, state.sample, {ray.origin, ray.direction}, hit, surface, picture,
                              time);
            }
            if (!is_black(surface.emission)) {
                const LightContext before(ray.origin, ray.normal, false, time);
                const float light_pdf = ray.bsdf_pdf > 0 ? pdf_direct<Choice>(scene, moves, before, surface) : 0.0f;
                add_emission(state, ray, surface.emission, light_pdf);
            }
        }
        if (surface.is_unlit || ray.depth >= settings.max_depth) return;
        const TreeVertex<kVariant, Choice> vertex = {picture, settings, trees, tree,  state,
                                                     ray,     surface,  time,  moves, {hit.u, hit.v}};
        sample_direct_lights(vertex);
        if (is_last) Algorithm::follow(vertex);
    }
    HD void sample_direct_lights(const TreeVertex<kVariant, Choice>& vertex) const {
        const uint32_t all = Algorithm::shadow_rays(picture.scene.lights);
        const uint32_t key = tree_key(vertex.state, settings.seed, vertex.number(), true);
        uint32_t slots[kShadowsAtOnce] = {};
        uint32_t count = 0;
        for (uint32_t number = first_shadow; number < min(all, first_shadow + kShadowsAtOnce); ++number) {
            TreeShadowRay shadow;
            if (!Algorithm::sample_direct_light(vertex, number, shadow)) continue;
            if constexpr (kVariant == ShadingVariant::General) {
                const Ray& line = shadow.ray;
                const float distance = line.t_max < kInfinity ? length(line.direction) : kInfinity;
                const InteriorList around = vertex.interior_towards(line.direction);
                const Rgb passed = around.top() != 0
                                       ? transmittance_within(picture.scene, around, distance)
                                       : transmittance_of_solid(picture.scene, vertex.surface.triangle, shadow.target,
                                                                line.direction, distance, vertex.time);
                shadow.contribution = shadow.contribution * passed;
            }
            const uint32_t slot = atomic_add(&trees.counts->shadows, 1u);
            trees.queue_shadow(slot, shadow, vertex.surface.triangle, key, vertex.time);
            slots[count++] = slot;
        }
        vertex.state.shadows = count;
        if (count > 0) trees.shadow_slots[vertex.tree] = {slots[0], slots[1], slots[2], slots[3]};
    }
};
static_assert(kShadowsAtOnce == 4, "TreesView::asked");

/// The stage that adds light of unoccluded shadow rays, tree by tree, in the order of requests.
struct AddTreeLight {
    TreesView trees;
    uint32_t round;

    HD void operator()(uint32_t i) const {
        const uint32_t tree = trees.owners[round % 2][i];
        TreeState& state = trees.states[tree];
        if (state.shadows == 0) return;
        const Uint4 shadow_slots = trees.shadow_slots[tree];
        const uint32_t slots[] = {shadow_slots.x, shadow_slots.y, shadow_slots.z, shadow_slots.w};
        Rgb radiance = state.radiance;
        for (uint32_t k = 0; k < state.shadows; ++k) {
            if (trees.shadow_keys[slots[k]] != kNoHit) continue;
            const Float4 c = trees.contributions[slots[k]];
            radiance += Rgb{c.x, c.y, c.z};
        }
        state.radiance = radiance;
    }
};

/// The stage that pops the next ray of each tree; a tree without one is added to the film.
struct TakeNextRays {
    CameraRays camera;
    RayTreeSettings settings;
    FilmView film;
    TreesView trees;
    uint32_t round;

    HD void operator()(uint32_t i) const {
        const uint32_t tree = trees.owners[round % 2][i];
        TreeState& state = trees.states[tree];
        if (state.pending == 0) return add_radiance(film, state.pixel, state.radiance);
        const PendingRay ray = trees.load_ray(tree, --state.pending);
        const uint32_t key = tree_key(state, settings.seed, state.rays++, false);
        const float time = trees.times != nullptr ? time_of(camera, settings, state) : kAtRest;
        trees.queue_ray(atomic_add(&trees.counts->next, 1u), tree, ray, key, time, round + 1);
    }
};

/// The stage that counts in one thread: shadow rays since the last time and, if `ends_round`, the rays that continue.
struct CountTrees {
    TreeCounts* counts;
    bool ends_round;

    HD void operator()(uint32_t) const {
        counts->all_shadows += counts->shadows;
        counts->shadows = 0;
        if (!ends_round) return;
        counts->bounces += counts->next;
        counts->rays = counts->next;
        counts->next = 0;
    }
};

/// The stage that starts the first round of `trees` in one thread.
struct BeginRounds {
    TreeCounts* counts;
    uint32_t trees;

    HD void operator()(uint32_t) const {
        counts->rays = trees;
        counts->next = counts->shadows = 0;
    }
};

} // namespace pertev
