#include "integrators/path/shade_lanes.h"

#include "math/lanes.h"

namespace pertev {
namespace {

using Floats = Floats8;

} // namespace
} // namespace pertev

#include "integrators/path/shade_lanes.inl"

namespace pertev {

const VertexShading kShadingOf8 = kShading;

const VertexShading& vertex_shading() {
#if defined(PERTEV_HAS_16_LANES)
    static const VertexShading& widest = takes_sixteen_lanes() ? kShadingOf16 : kShadingOf8;
    return widest;
#else
    return kShadingOf8;
#endif
}

bool can_shade_lanes(const PathJob& job) {
    constexpr Features kAllowed = kAllMaterials | kBatched | kNested | kLightTree;
    static const bool takes_lanes = shades_in_lanes();
    const bool is_vacuum = job.picture.scene.has_media == 0; // code for media serves thin walls, too
    return takes_lanes && (features_for(job) & ~(kAllowed | (is_vacuum ? Features{kMedia} : 0))) == 0 &&
           job.picture.scene.absorption != SolidAbsorption::OfEmitters && job.settings.light == PathLight::Path &&
           job.settings.strategy != LightStrategy::BsdfOnly;
}

} // namespace pertev
