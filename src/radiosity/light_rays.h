#pragma once

// Direct light of a patch by shadow rays to sample points on lights: irradiance of point, spot and directional lights
// and the environment, and form factors of emitters (patches that emit).

#include "radiosity/row_maker.h"

namespace pertev {

/// Number of light samples for a row, and the MIS weights of light that rays of another kind find too.
struct LightRays {
    uint32_t count = 0;          // rays
    uint32_t hemisphere = 0;     // number of rays of the other kind, with cosine density; 0: they find no light
    bool finds_emitters = false; // otherwise form factors account for emitters
    bool finds_sky_alone = true; // no other rays find the environment

    /// Weight of a sample with density `light_pdf`, 1/sr, and the `cosine` of its direction: the power heuristic for
    /// the numbers of samples of either kind.
    float weight_of_light(float light_pdf, float cosine) const;
    float weight_of_hemisphere(float light_pdf, float cosine) const;
};

/// Groups of a row's random numbers (math/sampler.h): position on the patch and direction; position, and point on a
/// light.
enum RowGroup : uint32_t { kGroupHemisphere, kGroupLights };

/// A point on a patch where its rays start.
struct PatchPoint {
    Vec3 position, error; // metres
    Vec3 normal;          // unit, out of the patch's side
};
PatchPoint point_on_patch(const SceneView& scene, const Patch& patch, Vec2 u);

/// Adds the direct light to `row`.
void add_light_rays(const RowScene& scene, const Patch& patch, SampleKey key, const LightRays& rays,
                    FormFactorRow& row);

} // namespace pertev
