#pragma once

// Ideal diffuse reflection, on the side of wo. Every BSDF in this folder has these functions, in the frame and with
// the units of bsdf_sample.h:
//   eval      f(wo, wi) |cos(wi)|, without delta lobes
//   pdf       density of sample() at wi; pdf > 0 wherever eval > 0
//   evaluate  both
//   sample    a wi, with weight = eval / pdf, from u_lobe and u in [0, 1)
// tests/statistical/bsdf_*_test.cpp hold every BSDF to that: chi-square of sample against pdf, mean of weight against
// the integral of eval, no energy gained, reciprocity.

#include "base/host_device.h"
#include "math/sampling.h"
#include "math/vec2.h"
#include "shading/bsdf_sample.h"

namespace pertev {

struct DiffuseBsdf {
    Rgb albedo; // [0, 1] per channel, linear Rec. 709

    HD BsdfValue evaluate(Vec3 wo, Vec3 wi) const {
        if (!(wo.z * wi.z > 0)) return {};
        const float pdf = abs(wi.z) * kInvPi;
        return {pdf * albedo, pdf};
    }
    HD Rgb eval(Vec3 wo, Vec3 wi) const { return evaluate(wo, wi).f; }
    HD float pdf(Vec3 wo, Vec3 wi) const { return evaluate(wo, wi).pdf; }
    HD BsdfSample sample(Vec3 wo, float, Vec2 u) const { // lobe choice unused: there is one lobe
        Vec3 wi = sample_cosine_hemisphere(u);
        wi.z = copysign(wi.z, wo.z);
        return make_bsdf_sample(wi, evaluate(wo, wi));
    }
};

} // namespace pertev
