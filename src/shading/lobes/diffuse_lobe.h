#pragma once

// Ideal diffuse reflection, on the side of wo. This is the lobe to read first: layer_transmittance.h defines the
// interface of lobes, and tests/statistical/bsdf_*_test.cpp check it for all: chi-square of sample against pdf, mean of
// weight against the integral of eval, energy conservation, reciprocity.

#include "base/host_device.h"
#include "math/sampling.h"
#include "math/vec2.h"
#include "shading/lobes/layer_transmittance.h"

namespace pertev {

struct DiffuseLobe {
    Rgb albedo;      // [0, 1] per channel, linear Rec. 709
    float share = 1; // factor on albedo, [0, 1]

    HD LobeClass lobe_class() const { return LobeClass::Diffuse; }
    HD float energy() const { return share * max_component(albedo); }

    HD BsdfValue evaluate(Vec3 wo, Vec3 wi, const LayerTransmittance& transmittance) const {
        if (!(wo.z * wi.z > 0)) return {};
        const float pdf = abs(wi.z) * kInvPi;
        return {(transmittance.light * (pdf * share * transmittance.near * transmittance.far / transmittance.average)) *
                    albedo,
                transmittance.reach * pdf};
    }
    HD LobeDraw draw(Vec3 wo, Vec2 u) const {
        Vec3 wi = sample_cosine_hemisphere(u);
        wi.z = copysign(wi.z, wo.z);
        return draw_direction(wi);
    }
};

} // namespace pertev
