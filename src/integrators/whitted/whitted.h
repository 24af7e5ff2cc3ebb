#pragma once

// Whitted's ray tracing: at a mirror or smooth glass both the reflected and the refracted ray are followed, weighted
// by Fresnel's terms. Other surfaces are lit by visible lights and by a constant ambient light.
//
// Source: Whitted, "An Improved Illumination Model for Shaded Display", CACM 23(6), 1980; rays with a negligible
// weight end: Hall, Greenberg, "A Testbed for Realistic Image Synthesis", 1983 (adaptive tree depth).

#include "integrators/ray_tree/tree_vertex.h"

namespace pertev {

struct Whitted {
    static constexpr uint32_t kMaxBranches = 2;
    static constexpr bool kHasShutter = true;
    static constexpr bool kSelectsLights = false;
    static constexpr MinWeight kMinWeight = {0x1p-10f, WeakRays::LeftOut};

    HD static uint32_t shadow_rays(const LightSetView& lights) { return lights.punctual_count; }
    HD static bool sample_direct_light(const auto& vertex, uint32_t number, TreeShadowRay& shadow) {
        return vertex.make_punctual_shadow_ray(number, shadow);
    }
    HD static void follow(const auto& vertex) {
        vertex.add_ambient();
        vertex.follow_specular(kMinWeight);
    }

    /// Default ambient light: the mean of the environment, which is right for a convex diffuse surface under a uniform
    /// sky.
    static Rgb ambient(const EnvironmentView* environment) {
        return environment != nullptr ? environment->mean : Rgb{0, 0, 0};
    }
};

} // namespace pertev
