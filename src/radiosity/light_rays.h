#pragma once

// What a patch receives by shadow rays to points drawn on lights: of point, spot and directional lights and the
// environment its irradiance, of lamps (patches that emit) form factors.

#include "radiosity/row_maker.h"

namespace pertev {

/// How often lights are drawn for a row, and how light that rays of another kind find as well is weighed.
struct LightRays {
    uint32_t count = 0;          // rays
    uint32_t hemisphere = 0;     // rays of the other kind, drawn by the cosine; 0: they find no light
    bool finds_lamps = false;    // else lamps are left to form factors
    bool finds_sky_alone = true; // nothing else finds the environment

    /// Of what a draw with density `light_pdf` has found, 1/sr, where `cosine` is that of its direction: the power
    /// heuristic over as many draws of either kind as there are.
    float weight_of_light(float light_pdf, float cosine) const;
    float weight_of_hemisphere(float light_pdf, float cosine) const;
};

/// The groups of a row's random numbers (math/sampler.h): place on the patch and direction; place, and point on a
/// light.
enum RowGroup : uint32_t { kGroupHemisphere, kGroupLights };

/// A place on a patch, from which its rays start.
struct PatchPlace {
    Vec3 position, error; // metres
    Vec3 normal;          // unit, out of the patch's side
};
PatchPlace place_on_patch(const SceneView& scene, const Patch& patch, Vec2 u);

/// Adds them to `row`.
void add_light_rays(const RowScene& scene, const Patch& patch, SampleKey key, const LightRays& rays,
                    FormFactorRow& row);

} // namespace pertev
