#pragma once

// A surface that a ray of a tree has hit, with the operations of an algorithm. Each algorithm
// (integrators/cast/cast.h, whitted/whitted.h, distributed/distributed.h) is a few lines on top of these.

#include "device_scene/moved_surface.h"
#include "device_scene/nested_solids.h"
#include "device_scene/ray_origin.h"
#include "integrators/ray_tree/ray_tree_settings.h"
#include "integrators/ray_tree/tree_memory.h"
#include "render/picture_view.h"
#include "render/scatter_calls.h"
#include "shading/chosen_by_tree.h"
#include "shading/power_heuristic.h"

namespace pertev {

/// Treatment of a ray whose weight is below the minimum: it is dropped, which loses its light, or kept at random with
/// a compensating weight (Russian roulette), which does not.
enum class WeakRays : uint8_t { LeftOut, ByChance };
struct MinWeight {
    float weight;
    WeakRays weaker;
};

/// Random numbers of a tree, in groups of four (math/sampler.h). Rays are numbered in the order in which they are
/// traced, and ray v ends at vertex v.
///   camera         position in the pixel, then the light of vertex 0
///   lens           position on the lens
///   scatter, of v  a glossy direction from vertex v, then the light of vertex v if that is not the first
///   choices, of v  the lobe, then whether weak rays are kept: mirror, refraction, glossy
enum TreeGroup : uint32_t { kTreeScatter, kTreeChoices, kTreeGroups };
inline constexpr uint32_t kTreeNumberLobe = 0;
enum class Branch : uint32_t { Mirror = 1, Refraction = 2, Glossy = 3 }; // values are indices among the choices

/// Key of the coin of blended surfaces for ray `number` of a tree; its vertex's shadow rays have another one.
HD inline uint32_t tree_key(const TreeState& tree, uint32_t seed, uint32_t number, bool is_shadow) {
    return coin_key({tree.pixel, tree.sample, seed}, number, is_shadow);
}

/// Time of all rays of a tree while the shutter is open.
HD inline float time_of(const CameraRays& camera, const RayTreeSettings& settings, const TreeState& tree) {
    return camera.time(settings.sampler, sample_key(settings, tree.pixel, tree.sample));
}

template <ShadingVariant kVariant, class Choice>
struct TreeVertex {
    const PictureView& picture;
    const RayTreeSettings& settings;
    const TreesView& trees;
    uint32_t tree;
    TreeState& state;
    const PendingRay& ray; // the ray that ends here
    const Surface& surface;
    float time; // time of all rays of the tree
    bool moves; // something moves while the shutter is open
    Vec2 uv;    // on the triangle: weights of its second and third corner

    HD Vec3 wo() const { return -ray.direction; }
    /// Returns the nested solids that hold a ray from here along `wi`.
    HD InteriorList interior_towards(Vec3 wi) const {
        const SceneView& scene = picture.scene;
        if (!scene.nesting.is_there() || surface.same_side(wo(), wi)) return ray.interior;
        return solids_behind(scene, ray.interior, surface.triangle.instance);
    }
    HD uint32_t number() const { return state.rays - 1; }
    HD SampleKey key() const { return sample_key(settings, state.pixel, state.sample); }
    HD uint32_t group(TreeGroup of) const { return kCameraGroups + number() * kTreeGroups + of; }

    /// Requests light of the punctual light `light`, for all lobes but delta ones. Returns true if `shadow` must be
    /// traced.
    HD bool make_punctual_shadow_ray(uint32_t light, TreeShadowRay& shadow) const {
        LightSample sample;
        const LightSetView& lights = picture.scene.lights;
        if (surface.bsdf.has_delta_only()) return false;
        if (!sample_punctual_light<emitter_variant(kVariant)>(lights, light, 1.0f, surface.position, sample))
            return false;
        const BsdfValue all = evaluate_surface<kVariant>(surface, wo(), sample.wi);
        return make_shadow_ray(sample, all.f * sample.radiance, shadow);
    }

    /// Requests one point of one light that Choice selects, including emitters and the environment. A glossy ray may
    /// hit these too, so what glossy lobes scatter of them is weighted by the power heuristic.
    HD bool make_drawn_shadow_ray(TreeShadowRay& shadow) const {
        if (surface.bsdf.has_delta_only()) return false;
        const uint32_t of = number() == 0 ? uint32_t(kGroupCamera) : group(kTreeScatter);
        LightSample sample;
        const SampleBits u = sample_bits(settings.sampler, key(), of, Pair::Last);
        constexpr EmitterVariant kEmitters = emitter_variant(kVariant);
        if (!draw_direct<kEmitters, Choice>(picture.scene, moves, surface.light_context(wo(), time), u, sample)) {
            return false;
        }
        const BsdfValue all = evaluate_surface<kVariant>(surface, wo(), sample.wi);
        if (is_black(all.f) || is_hole(sample)) return false;
        Rgb f = all.f;
        if (!sample.is_delta && surface.bsdf.has(LobeClass::Glossy)) {
            const Rgb glossy = evaluate_surface<kVariant>(surface, wo(), sample.wi, only(LobeClass::Glossy)).f;
            f = f - (1.0f - power_heuristic(sample.pdf, all.pdf)) * glossy;
        }
        return make_shadow_ray(sample, f * ((1.0f / sample.pdf) * sample.radiance), shadow);
    }

    /// Adds the light that the diffuse lobe scatters of a constant radiance from all directions (Whitted's ambient
    /// term).
    HD void add_ambient() const { state.radiance += ray.weight * surface.bsdf.diffuse_albedo() * settings.ambient; }

    /// Pushes rays along the directions of the delta lobes: both branches.
    HD void follow_specular(MinWeight least) const {
        if (!surface.bsdf.has_delta()) return;
        const Vec3 wo_local = surface.frame.to_local(wo());
        const SpecularBranches branches = surface.bsdf.specular(wo_local);
        // The refraction is deeper in the stack, so the mirror's subtree comes first.
        follow_delta(branches.refraction, wo_local, branches.refracted, Branch::Refraction, least);
        follow_delta(branches.mirror, wo_local, {-wo_local.x, -wo_local.y, wo_local.z}, Branch::Mirror, least);
    }

    /// Pushes one ray along a direction sampled by the glossy lobes.
    HD void follow_glossy(MinWeight least) const {
        if (!surface.bsdf.has(LobeClass::Glossy)) return;
        const float lobe =
            surface.bsdf.draws_lobe() ? sample_1d(settings.sampler, key(), group(kTreeChoices), kTreeNumberLobe) : 0.5f;
        const BsdfSample drawn =
            sample_surface<kVariant>(surface, wo(), lobe, sample_2d(settings.sampler, key(), group(kTreeScatter)));
        if (!(drawn.pdf > 0) || drawn.is_delta()) return; // delta lobes have their own rays
        const BsdfValue value = evaluate_surface<kVariant>(surface, wo(), drawn.wi, only(LobeClass::Glossy));
        if (!(value.pdf > 1e-30f)) return;
        follow(drawn.wi, (1.0f / value.pdf) * value.f, value.pdf, Branch::Glossy, least);
    }

private:
    /// Makes the shadow ray to a light sample; `f_times_light` arrives if it is unoccluded.
    HD bool make_shadow_ray(const LightSample& light, Rgb f_times_light, TreeShadowRay& shadow) const {
        if (is_black(f_times_light)) return false;
        const float emitter_error = moves ? emitter_error_at(picture.scene, light, time) : 0.0f;
        shadow.ray = ray_to_light(light, surface.position, surface.error, surface.geometric_normal, emitter_error);
        shadow.target = triangle_of(light);
        shadow.contribution = ray.weight * f_times_light;
        return true;
    }
    /// Returns whether the sampled point lies in a transparent part of the emitter.
    HD bool is_hole(const LightSample& light) const {
        return pertev::is_hole(picture.scene, light, tree_key(state, settings.seed, number(), true));
    }
    HD void follow_delta(Rgb weight, Vec3 wo_local, Vec3 wi_local, Branch branch, MinWeight least) const {
        Vec3 wi;
        if (is_black(weight) || !surface.place_specular(wo(), wo_local, wi_local, wi)) return;
        follow(wi, weight, 0, branch, least);
    }
    HD void follow(Vec3 wi, Rgb factor, float bsdf_pdf, Branch branch, MinWeight least) const {
        PendingRay child;
        child.weight = ray.weight * factor;
        const float largest = max_component(child.weight);
        if (!(largest > 0)) return;
        if (largest < least.weight) {
            if (least.weaker == WeakRays::LeftOut) return;
            const float u = sample_1d(settings.sampler, key(), group(kTreeChoices), static_cast<uint32_t>(branch));
            if (!(u * least.weight < largest)) return;
            child.weight = (least.weight / largest) * child.weight;
        }
        child.origin = offset_ray_origin(surface.position, surface.error, surface.geometric_normal, wi);
        child.direction = wi;
        child.bsdf_pdf = bsdf_pdf;
        child.depth = ray.depth + 1;
        child.start = surface.triangle;
        if constexpr (kVariant == ShadingVariant::General) {
            trees.store_interior(tree, state.pending, interior_towards(wi));
        }
        if constexpr (Choice::kReadsNormal) {
            trees.store_normal(tree, state.pending, surface.light_context(wo(), time).normal);
        }
        trees.store_ray(tree, state.pending++, child);
    }
};

} // namespace pertev
