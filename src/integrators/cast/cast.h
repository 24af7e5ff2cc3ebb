#pragma once

// Ray casting: the first hit of a camera ray is lit by the lights that it sees, and nothing else.
//
// Source: Appel, "Some Techniques for Shading Machine Renderings of Solids", AFIPS 1968.

#include "integrators/ray_tree/tree_vertex.h"

namespace pertev {

struct Cast {
    static constexpr uint32_t kMaxBranches = 0; // continuation rays per vertex
    static constexpr bool kHasShutter = true;
    static constexpr bool kSelectsLights = false;

    /// Number of shadow rays of a vertex: one for each point, spot and directional light.
    HD static uint32_t shadow_rays(const LightSetView& lights) { return lights.punctual_count; }
    HD static bool sample_direct_light(const auto& vertex, uint32_t number, TreeShadowRay& shadow) {
        return vertex.make_punctual_shadow_ray(number, shadow);
    }
    HD static void follow(const auto& vertex) { vertex.add_ambient(); }

    /// Default ambient light: none.
    static Rgb ambient(const EnvironmentView*) { return {0, 0, 0}; }
};

} // namespace pertev
