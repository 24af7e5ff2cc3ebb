#include "integrators/path/shade_lanes.h"

#include "math/lanes.h"

namespace pertev {
namespace {

using Floats = Floats8;

} // namespace
} // namespace pertev

#include "integrators/path/shade_lanes.inl"

namespace pertev {

const VertexShading kShadingOf8 = {kLanes, shade_lanes};

const VertexShading& vertex_shading() {
#if defined(PERTEV_HAS_16_LANES)
    static const VertexShading& widest = takes_sixteen_lanes() ? kShadingOf16 : kShadingOf8;
    return widest;
#else
    return kShadingOf8;
#endif
}

bool can_shade_lanes(const PathJob& job) {
    constexpr Features kAllowed = kAllMaterials | kBatched | kLightTree;
    return (features_for(job) & ~kAllowed) == 0 && job.picture.scene.has_plain_light != 0 &&
           job.settings.light == PathLight::Path && job.settings.strategy != LightStrategy::BsdfOnly;
}

} // namespace pertev
