#pragma once

// How a lobe stands in its BSDF: a *base* (diffuse, conductor, dielectric) lies innermost; a *layer* (the reflection of
// a glTF material, coat, sheen) scatters some light and leaves the rest to what is beneath it. Every lobe is a file of
// this folder and has, in the frame and units of bsdf_sample.h:
//   lobe_class  what it scatters
//   energy      about the largest share of light that it scatters, [0, 1]: how often it is drawn from beneath a layer
//   evaluate    value and density of what it adds under a Passage; a layer then moves the Passage to beneath itself
//   gloss       seen at a cosine: what a denoiser is told (shading/lobes/gloss.h); none of a diffuse lobe
//   draw        a direction from u_lobe and u in [0, 1), or word that what is beneath is to draw one
//   specular    what it sends along single directions, as if it were alone; a lobe that is diffuse has none
// A layer also takes `beneath`, the energy of all that it lies on.

#include "base/host_device.h"
#include "math/scalar.h"
#include "shading/lobes/bsdf_sample.h"
#include "shading/lobes/gloss.h"

namespace pertev {

/// What the layers above leave to a lobe, for one pair of directions.
struct Passage {
    float light = 1; // factor on values, [0, 1]: of layers that may lie on anything
    float reach = 1; // probability that sample() comes this deep

    // Of a layer that lies on a diffuse base alone: the base is scaled by near far / average, so that all light which
    // the layer leaves is scattered (Kelemen & Szirmay-Kalos 2001).
    float near = 1, far = 1, average = 1;

    /// Beneath a layer of albedo `at_o` and `at_i` that is drawn past with probability `p_beneath`. The factor is
    /// reciprocal, and whatever lies beneath, no light is gained: it is at most 1 - at_o (KHR_materials_sheen).
    HD void pass(float at_o, float at_i, float p_beneath) {
        light = light * (1.0f - max(at_o, at_i));
        reach = reach * p_beneath;
    }
};

/// What delta lobes send along the only two directions that they have: into wo comes `mirror` of the light from the
/// mirror image of wo, and `refraction` of the light from `refracted`. Nothing is drawn.
struct SpecularBranches {
    Rgb mirror = {}, refraction = {}; // [0, 1]
    Vec3 refracted = {};              // unit, on the other side; where `refraction` is not black
};

/// What draw() gives.
struct LobeDraw {
    BsdfSample sample = {};  // of a delta lobe as if it were alone; else wi and is_transmission; pdf 0: nothing
    float u_lobe = 0;        // for what is beneath
    bool is_beneath = false; // what is beneath draws
};

HD inline LobeDraw draw_direction(Vec3 wi, bool is_transmission = false) {
    return {.sample = {.wi = wi, .pdf = 1, .is_transmission = is_transmission}};
}
HD inline LobeDraw draw_mirror(Vec3 wo, Rgb weight, float probability) {
    return {.sample = {.wi = {-wo.x, -wo.y, wo.z}, .weight = weight, .pdf = probability}};
}
HD inline LobeDraw draw_beneath(float u_lobe, float p_beneath) {
    return {.u_lobe = min(u_lobe / p_beneath, 0x1.fffffep-1f), .is_beneath = true};
}

} // namespace pertev
