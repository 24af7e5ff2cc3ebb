#pragma once

// Position of a lobe in its BSDF: a *base* (diffuse, conductor, dielectric) is innermost; a *layer* (the reflection
// of a glTF material, coat, sheen) scatters some light and transmits the rest to what is beneath it. Every lobe is a
// file of this folder and has, in the frame and units of bsdf_sample.h:
//   lobe_class  its kind of scattering
//   energy      approximate maximum fraction of scattered light, [0, 1]: sets how often it is sampled beneath a layer
//   evaluate    value and density that it adds under a LayerTransmittance; a layer then moves the LayerTransmittance
//   beneath itself gloss       guide for denoisers at a cosine (shading/lobes/gloss.h); diffuse lobes have none draw
//   samples a direction from u_lobe and u in [0, 1), or returns that what is beneath must sample one specular    light
//   along single directions, as if it were alone; diffuse lobes have none
// A layer also takes `beneath`, the energy of everything beneath it.

#include "base/host_device.h"
#include "math/rgb.h"
#include "math/scalar.h"
#include "shading/lobes/bsdf_sample.h"
#include "shading/lobes/gloss.h"

namespace pertev {

/// Transmittance of the layers above a lobe, for one pair of directions.
struct LayerTransmittance {
    float light = 1;      // factor on values, [0, 1], from layers that may lie on anything
    float reach = 1;      // probability that sample() gets this deep
    Rgb tint = {1, 1, 1}; // factor on values of all lobes beneath, which their stack multiplies, [0, 1]

    // Coats return light to rough metal (coated_table.h), if their stack says how wide it is.
    float metal_alpha = 0, metal_share = 0; // its GGX width, and its share of what it reflects; 0 without one
    float returned = 1;                     // factor on `light` for it, at least 1

    // From a layer that lies only on a diffuse base: the base is scaled by near far / average, so that all light that
    // the layer transmits is scattered (Kelemen & Szirmay-Kalos 2001).
    float near = 1, far = 1, average = 1;

    /// Factor on light that lobes beneath both kinds scatter along single directions or into lobes: reciprocal, and at
    /// most the transmittance from either side.
    HD float light_of_delta() const { return light * min(near, far); }

    HD float light_on_metal() const { return light * returned; }

    /// Passes a layer with albedo `at_o` and `at_i` that sampling passes with probability `p_beneath`. The factor is
    /// reciprocal and at most 1 - at_o, so no light is gained whatever lies beneath (KHR_materials_sheen).
    HD void pass(float at_o, float at_i, float p_beneath) {
        light = light * (1.0f - max(at_o, at_i));
        reach = reach * p_beneath;
    }
};

/// Light that delta lobes scatter along their only two directions: wo receives `mirror` of the light from the mirror
/// image of wo, and `refraction` of the light from `refracted`. Nothing is sampled.
struct SpecularBranches {
    Rgb mirror = {}, refraction = {}; // [0, 1]
    Vec3 refracted = {};              // unit, on the other side; valid if `refraction` is not black
};

/// Result of a lobe's draw().
struct LobeDraw {
    BsdfSample sample = {};  // for a delta lobe as if it were alone; else only wi and is_transmission are set; pdf 0:
                             // no sample
    float u_lobe = 0;        // random number for sampling what is beneath
    bool is_beneath = false; // whether what is beneath must sample
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
