#pragma once

// Distributed ray tracing: Whitted's tree, but if light comes from many directions or points, a sample takes one of
// them: a point on an emitter or the sky, a direction of a glossy lobe, a point on the lens. Soft shadows, glossy
// reflections and depth of field are means over the samples.
//
// Source: Cook, Porter, Carpenter, "Distributed Ray Tracing", SIGGRAPH 1984.
//
// It is unbiased for light that at most one surface scatters diffusely, the last one before the light:
// L(D|S|G)?(S|G)*E in Heckbert's notation. Light from another surface to a diffuse one is missing: there is neither
// diffuse interreflection nor caustics.

#include "integrators/ray_tree/tree_vertex.h"

namespace pertev {

struct Distributed {
    static constexpr uint32_t kMaxBranches = 3;
    static constexpr bool kHasShutter = true;
    static constexpr bool kSelectsLights = true;
    static constexpr MinWeight kMinWeight = {0x1p-4f, WeakRays::ByChance};

    HD static uint32_t shadow_rays(const LightSetView&) { return 1; }
    HD static bool sample_direct_light(const auto& vertex, uint32_t, TreeShadowRay& shadow) {
        return vertex.make_drawn_shadow_ray(shadow);
    }
    HD static void follow(const auto& vertex) {
        vertex.follow_glossy(kMinWeight);
        vertex.follow_specular(kMinWeight);
    }

    static Rgb ambient(const EnvironmentView*) { return {0, 0, 0}; } // light from all directions is sampled instead
};

} // namespace pertev
