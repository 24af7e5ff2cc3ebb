#pragma once

// Operations of camera and light subpaths at a surface.

#include "base/host_device.h"
#include "device_scene/solid_absorption.h"
#include "integrators/subpaths/subpath_memory.h"
#include "integrators/subpaths/subpath_settings.h"
#include "render/picture_view.h"
#include "render/scatter_calls.h"
#include "shading/chosen_by_tree.h"
#include "shading/survival.h"

namespace pertev {

/// Scene, lights and settings of subpaths.
struct SubpathScene {
    PictureView picture;
    SubpathSettings settings;
    WorldSphere world;
    bool is_connected; // subpaths connect and contributions have MIS weights; else there are only particles
};

/// Returns whether next-event estimation selects lights by a tree.
inline bool uses_light_tree(const SubpathScene& scene) {
    return uses_light_tree(scene.settings.light_choice, scene.picture.scene);
}

/// Stores the normal of the context by which `end` selects lights for the direction `wo`, before a ray leaves there.
template <class Choice, class End>
HD inline void store_light_normal(const SubpathsView& subpaths, uint32_t subpath, const End& end, Vec3 wo) {
    if constexpr (Choice::kReadsNormal) subpaths.normals[subpath] = end.light_context(wo).normal;
}
/// Returns the context with which next-event estimation selected a light where the subpath's ray begins, except for the
/// offset of the ray's origin.
template <class Choice>
HD inline LightContext light_context_before(const SubpathsView& subpaths, uint32_t subpath, Vec3 origin) {
    if constexpr (Choice::kReadsNormal) return {origin, subpaths.normals[subpath], false, kAtRest};
    return {origin};
}

/// A surface's scattering between two directions, for a camera subpath (light along wi to wo) and for a particle
/// (from wi, along wo); each is the other's reverse.
struct BothWays {
    BsdfValue camera, particle;
};
template <ShadingVariant kVariant>
HD inline BothWays scatter_both_ways(const Surface& surface, Vec3 wo, Vec3 wi) {
    return {evaluate_surface<kVariant>(surface, wo, wi), evaluate_particle<kVariant>(surface, wi, wo)};
}

HD inline float cosine_at(const Surface& surface, Vec3 direction) {
    return abs(dot(surface.geometric_normal, direction));
}

/// Multiplies each of `weights`, all Rgb, by the transmittance of the solid that ray `i` of a round went through to
/// `hit`.
template <ShadingVariant kVariant, class... Weights>
HD inline void arrive_through_solids(const SubpathScene& scene, const SubpathsView& subpaths, uint32_t i,
                                     uint32_t round, const Ray& ray, const Hit& hit, Weights&... weights) {
    if constexpr (kVariant == ShadingVariant::General) {
        const Rgb passed =
            transmittance_to_hit<kVariant>(scene.picture.scene, subpaths.start_of(i, round), ray.direction, hit);
        ((weights = weights * passed), ...);
    }
}

/// Russian roulette from a subpath's vertex `vertex` (counted from 1) on: the survival probability is the square root
/// of the vertex's throughput, or survival_after_delta(), by the same rule on both sides. The throughput compensates
/// for it, so the mean is unbiased; MIS weights ignore it. Returns false if the subpath ends.
HD inline bool survives(const SubpathSettings& settings, SampleKey key, uint32_t group, uint32_t vertex,
                        BsdfSample& sample) {
    if (vertex < settings.roulette_depth) return true;
    float chance = sqrt(max_component(sample.weight));
    if (sample.is_delta()) chance = survival_after_delta(vertex, chance);
    if (!(chance < 1)) return true;
    if (!(sample_1d(settings.sampler, key, group, kNumberOfRoulette) < chance)) return false;
    sample.weight = (1.0f / chance) * sample.weight;
    return true;
}

/// Random numbers that sample the lobe and the direction of a subpath's scattering.
struct ScatterDraw {
    float lobe;
    Vec2 u;
};
HD inline ScatterDraw draw_scatter(const SubpathSettings& settings, SampleKey key, const Bsdf& bsdf,
                                   uint32_t scatter_group, uint32_t choices_group) {
    ScatterDraw draw = {0.5f, {}};
    if (bsdf.draws_lobe()) draw.lobe = sample_1d(settings.sampler, key, choices_group, kNumberOfLobe);
    draw.u = sample_2d(settings.sampler, key, scatter_group);
    return draw;
}

/// A vertex of a subpath on a surface. MediumEnd (subpath_media.h) has the same functions for one in a medium.
template <ShadingVariant kVariant>
struct SurfaceEnd {
    const Surface& surface;

    HD Vec3 position() const { return surface.position; }
    HD TriangleId triangle() const { return surface.triangle; }
    HD bool scatters_by_delta_alone() const { return surface.bsdf.has_delta_only(); }
    /// Returns what multiplies a density over solid angle at another vertex, besides the squared distance, to give one
    /// at this vertex.
    HD float density_factor(Vec3 direction) const { return cosine_at(surface, direction); }
    HD BothWays scatter(Vec3 wo, Vec3 wi) const { return scatter_both_ways<kVariant>(surface, wo, wi); }
    HD BsdfValue scatter_camera(Vec3 wo, Vec3 wi) const { return evaluate_surface<kVariant>(surface, wo, wi); }
    HD Vec3 origin_towards(Vec3 direction) const {
        return offset_ray_origin(surface.position, surface.error, surface.geometric_normal, direction);
    }
    HD LightContext light_context(Vec3 wo) const { return surface.light_context(wo); }
    HD Ray ray_to(const LightSample& light) const {
        return ray_to_light(light, surface.position, surface.error, surface.geometric_normal);
    }
    /// Returns whether the directions `a` and `b` are on one side.
    HD bool same_side(Vec3 a, Vec3 b) const { return surface.same_side(a, b); }
    HD ScatterDraw draw(const SubpathSettings& settings, SampleKey key, uint32_t scatter_group,
                        uint32_t choices_group) const {
        return draw_scatter(settings, key, surface.bsdf, scatter_group, choices_group);
    }
    HD BsdfSample sample_camera(Vec3 wo, const ScatterDraw& draw) const {
        return sample_surface<kVariant>(surface, wo, draw.lobe, draw.u);
    }
    HD BsdfSample sample_particle(Vec3 wi, const ScatterDraw& draw) const {
        return pertev::sample_particle<kVariant>(surface, wi, draw.lobe, draw.u);
    }
    HD bool survives(const SubpathSettings& settings, SampleKey key, uint32_t group, uint32_t vertex,
                     BsdfSample& sample) const {
        return pertev::survives(settings, key, group, vertex, sample);
    }
    HD float squared_index_beyond(Vec3 wi, float here) const { return pertev::squared_index_beyond(surface, wi, here); }
    HD float squared_index_along(Vec3 wi, Vec3 wo, float here) const {
        return pertev::squared_index_along(surface, wi, wo, here);
    }
};

} // namespace pertev
