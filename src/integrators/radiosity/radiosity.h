#pragma once

// Renders a radiosity solution (radiosity/radiosity_solution.h): diffuse surfaces reflect the light that their
// patches receive, with their texture; mirrors and smooth glass are followed as in Whitted's ray tracing. Glossy
// lobes contribute nothing.
//
// Source: Goral et al. 1984, section 6; the second pass by rays: Wallace, Cohen, Greenberg, "A Two-Pass Solution to the
// Rendering Equation", SIGGRAPH 1987.

#include "integrators/ray_tree/tree_vertex.h"

namespace pertev {

struct Radiosity {
    static constexpr uint32_t kMaxBranches = 2;
    static constexpr bool kHasShutter = false;
    static constexpr bool kSelectsLights = false;
    static constexpr MinWeight kMinWeight = {0x1p-10f, WeakRays::LeftOut};

    HD static uint32_t shadow_rays(const LightSetView&) { return 0; }
    HD static bool sample_direct_light(const auto&, uint32_t, TreeShadowRay&) { return false; }
    HD static void follow(const auto& vertex) {
        const Rgb albedo = vertex.surface.bsdf.diffuse_albedo();
        if (!is_black(albedo)) {
            const SceneView& scene = vertex.picture.scene;
            const TriangleId at = vertex.surface.triangle;
            const uint32_t side = dot(vertex.surface.geometric_normal, vertex.wo()) > 0 ? 0 : 1;
            const uint32_t face = 2 * (scene.first_triangle[at.instance] + at.primitive) + side;
            const Rgb light = vertex.settings.radiosity.irradiance(face, vertex.uv.x, vertex.uv.y);
            vertex.state.radiance += vertex.ray.weight * albedo * (kInvPi * light);
        }
        vertex.follow_specular(kMinWeight);
    }

    /// Default ambient light: none, because the solution contains it.
    static Rgb ambient(const EnvironmentView*) { return {0, 0, 0}; }
};

} // namespace pertev
