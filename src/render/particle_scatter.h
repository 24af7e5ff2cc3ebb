#pragma once

// The adjoint of Surface::evaluate and Surface::sample: scattering of a particle that carries power from the lights.
// It arrives from `wi` and continues along `wo`; both point away from the surface.
//
// A BSDF needs no separate function for that: in its units (bsdf_sample.h) evaluate(wi, wo) is its adjoint. But a
// surface's value K'(wo, wi) also contains raised directions and a cosine with the shading normal, where power needs
// the one with the triangle's normal. With etendue n^2 |w . Ng| dw the adjoint of K' is K'(wo, wi) n_o^2 |wo . Ng| /
// (n_i^2 |wi . Ng|). By the reciprocity of the BSDF f this equals, with l being wi lowered and `slope` its slope,
//     f(l, wo) |l . Ns| |wo . Ng| / (|wo . Ns| |wi . Ng| slope),
// which contains no index (Veach 1997, section 5.3, has it without the raise). It is not the adjoint for a delta
// direction that is folded back at the triangle's plane, nor for a normal that valid_normal has turned, which then
// depends on wo.

#include "device_scene/surface.h"

namespace pertev {

namespace particle {

/// The direction for which the BSDF is evaluated: wi lowered, or unchanged for pure delta lobes, as in Surface::sample.
HD inline RaisedDirection lowered(const Surface& surface, Vec3 wi_local) {
    if (!(surface.tilt > 0) || surface.bsdf.has_delta_only()) return {wi_local, 1.0f};
    return lower_direction(wi_local, surface.tilt);
}
/// Returns whether a surface has delta lobes beside others that use the lowered direction; then half of the samples are
/// drawn for each.
HD inline bool is_split(const Surface& surface, const RaisedDirection& from) {
    return from.slope < 1 && surface.bsdf.has_delta() && !surface.bsdf.has_delta_only();
}
HD inline float factor(const Surface& surface, Vec3 wo, Vec3 wi, Vec3 wo_local, const RaisedDirection& from) {
    const float there = abs(dot(wo, surface.geometric_normal)), here = abs(dot(wi, surface.geometric_normal));
    return abs(from.direction.z) * there / (abs(wo_local.z) * here * from.slope);
}

} // namespace particle

/// Square of the refractive index beyond a surface for a particle from `wi`, where it is `here`; a thin wall has the
/// same on both sides. Power is the same on both sides; radiance over n^2 (bsdf_sample.h) is arriving power divided by
/// that square.
HD inline float squared_index_beyond(const Surface& surface, Vec3 wi, float here) {
    const float ior = surface.bsdf.inner_ior();
    if (ior == 1) return here;
    const float squared = square(ior);
    return surface.frame.to_local(wi).z > 0 ? here * squared : here / squared;
}
/// Square of the refractive index along `wo`: `here`, unless the particle is transmitted through glass.
HD inline float squared_index_along(const Surface& surface, Vec3 wi, Vec3 wo, float here) {
    return surface.same_side(wo, wi) ? here : squared_index_beyond(surface, wi, here);
}

/// Power scattered per solid angle of `wo` for a power of 1 from `wi`, by the lobes of `classes`, and the density of
/// sample_adjoint() at wo. Both directions are unit, in world space. Delta lobes contribute nothing.
template <BsdfPass kPass = BsdfPass::Copied>
HD inline BsdfValue evaluate_adjoint(const Surface& surface, Vec3 wi, Vec3 wo, LobeClasses classes = kAllLobeClasses) {
    const Vec3 wo_local = surface.frame.to_local(wo), wi_local = surface.frame.to_local(wi);
    if (!surface.is_consistent(wo, wi, wo_local, wi_local)) return {};
    const RaisedDirection from = particle::lowered(surface, wi_local);
    if (!(from.slope > 0)) return {};
    const BsdfValue value = surface.bsdf.evaluate<kPass>(from.direction, wo_local, classes);
    if (!(value.pdf > 0)) return {};
    return {particle::factor(surface, wo, wi, wo_local, from) * value.f,
            particle::is_split(surface, from) ? 0.5f * value.pdf : value.pdf};
}

/// Samples the direction in which a particle from `wi` (unit, world space) is scattered: it is the sample's `wi`, and
/// its weight multiplies the particle's power. pdf 0 means absorption. With a bent normal the weight is unbounded as wo
/// nears its horizon.
template <BsdfPass kPass = BsdfPass::Copied>
HD inline BsdfSample sample_adjoint(const Surface& surface, Vec3 wi, float u_lobe, Vec2 u) {
    const Vec3 wi_local = surface.frame.to_local(wi);
    RaisedDirection from = particle::lowered(surface, wi_local);
    const bool splits = particle::is_split(surface, from), draws_delta = splits && u_lobe < 0.5f;
    if (splits) u_lobe = draws_delta ? 2.0f * u_lobe : 2.0f * u_lobe - 1.0f;
    if (draws_delta) from = {wi_local, 1.0f};
    if (!(from.slope > 0)) return {};

    BsdfSample sample = surface.bsdf.sample<kPass>(from.direction, u_lobe, u);
    if (!(sample.pdf > 0) || is_black(sample.weight)) return {};
    if (splits && sample.is_delta() != draws_delta) return {};
    const Vec3 wo_local = sample.wi, wo = normalize(surface.frame.to_world(wo_local));
    if (!surface.is_consistent(wo, wi, wo_local, wi_local)) return {};
    sample.wi = wo;
    sample.weight = (particle::factor(surface, wo, wi, wo_local, from) * (splits ? 2.0f : 1.0f)) * sample.weight;
    if (splits) sample.pdf = 0.5f * sample.pdf;
    return sample;
}

} // namespace pertev
