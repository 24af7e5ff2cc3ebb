#pragma once

// Distributed ray tracing: Whitted's tree, but where light comes from many directions, points or places at once, a
// sample takes one of them: a point of a lamp or of the sky, a direction of a glossy lobe, a place on the lens. Soft
// shadows, blurred reflections and depth of field are means over the samples.
//
// Source: Cook, Porter, Carpenter, "Distributed Ray Tracing", SIGGRAPH 1984.
//
// Unbiased for light that at most one surface scatters diffusely, the last one before the light: in Heckbert's words
// L(D|S|G)?(S|G)*E. Light that a diffuse surface gets from another surface is not there: neither diffuse
// interreflection nor caustics.

#include "integrators/ray_tree/tree_vertex.h"

namespace pertev {

struct Distributed {
    static constexpr uint32_t kMostBranches = 3;
    static constexpr bool kHasShutter = true;
    static constexpr LeastWeight kLeast = {0x1p-4f, WeakRays::ByChance};

    HD static uint32_t shadow_rays(const LightSetView&) { return 1; }
    HD static bool ask_for_light(const TreeVertex& vertex, uint32_t, TreeShadowRay& shadow) {
        return vertex.ask_for_drawn_light(shadow);
    }
    HD static void follow(const TreeVertex& vertex) {
        vertex.follow_glossy(kLeast);
        vertex.follow_specular(kLeast);
    }

    static Rgb ambient(const EnvironmentView*) { return {0, 0, 0}; } // the light of all around is drawn
};

} // namespace pertev
