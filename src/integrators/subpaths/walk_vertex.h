#pragma once

// What both kinds of walks do where they meet a surface.

#include "base/host_device.h"
#include "integrators/subpaths/subpath_settings.h"
#include "integrators/subpaths/walk_memory.h"
#include "render/particle_scatter.h"
#include "render/picture_view.h"

namespace pertev {

/// What walks are made of.
struct WalkScene {
    PictureView picture;
    SubpathSettings settings;
    WorldSphere world;
    bool is_joined; // walks from both sides are joined, and what each way brings is weighted; else particles alone
};

/// A surface's scattering between two directions, as a walk from the camera has it (light along wi to wo) and as a
/// particle has it (from wi, on along wo): each is the other's way back. Out of line where it is long: a kernel holds
/// it once.
struct BothWays {
    BsdfValue eye, particle;
};
HD_CALL inline BothWays scatter_both_ways_of_any(const Surface& surface, Vec3 wo, Vec3 wi) {
    return {surface.evaluate(wo, wi), evaluate_adjoint(surface, wi, wo)};
}
template <MaterialsKnown kKnown>
HD inline BothWays scatter_both_ways(const Surface& surface, Vec3 wo, Vec3 wi) {
    if constexpr (kKnown == MaterialsKnown::Nothing) return scatter_both_ways_of_any(surface, wo, wi);
    return {surface.evaluate(wo, wi), evaluate_adjoint(surface, wi, wo)};
}

HD inline float cosine_at(const Surface& surface, Vec3 direction) {
    return abs(dot(surface.geometric_normal, direction));
}

/// Russian roulette, from a walk's vertex `vertex` (counted from 1) on: the chance to go on is the square root of what
/// the vertex lets through, the same rule from both sides. What goes on is made up for, so nothing is lost in the mean;
/// weights do not know of it. False: the walk ends.
HD inline bool survives(const SubpathSettings& settings, SampleKey key, uint32_t group, uint32_t vertex, Rgb& weight) {
    if (vertex < settings.roulette_depth) return true;
    const float chance = sqrt(max_component(weight));
    if (!(chance < 1)) return true;
    if (!(sample_1d(settings.sampler, key, group, kNumberOfRoulette) < chance)) return false;
    weight = (1.0f / chance) * weight;
    return true;
}

/// The lobe and the direction that a walk is scattered by are drawn from here.
struct WalkDraw {
    float lobe;
    Vec2 u;
};
HD inline WalkDraw draw_scatter(const SubpathSettings& settings, SampleKey key, const Bsdf& bsdf,
                                uint32_t scatter_group, uint32_t choices_group) {
    WalkDraw draw = {0.5f, {}};
    if (bsdf.draws_lobe()) draw.lobe = sample_1d(settings.sampler, key, choices_group, kNumberOfLobe);
    draw.u = sample_2d(settings.sampler, key, scatter_group);
    return draw;
}

} // namespace pertev
