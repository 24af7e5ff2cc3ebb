#pragma once

// The adjoint of Surface::evaluate and Surface::sample: how a particle that carries power away from the lights is
// scattered. It came from `wi` and goes on along `wo`; both point away from the surface.
//
// A BSDF needs no function of its own for that: in its units (bsdf_sample.h) evaluate(wi, wo) is its adjoint. A
// surface's value K'(wo, wi) also holds raised directions and a cosine to the shading normal, where power asks for that
// to the triangle. With etendue n^2 |w . Ng| dw the adjoint of K' is K'(wo, wi) n_o^2 |wo . Ng| / (n_i^2 |wi . Ng|),
// and by the reciprocity of the BSDF f this is, l being wi lowered, with `slope` there,
//     f(l, wo) |l . Ns| |wo . Ng| / (|wo . Ns| |wi . Ng| slope),
// in which no index is left (Veach 1997, section 5.3, has it without the raise). What it is not the adjoint of: a delta
// direction folded back at the triangle's plane, and a normal that valid_normal has turned, which then depends on wo.

#include "device_scene/surface.h"

namespace pertev {

namespace particle {

/// The direction at which the BSDF is asked: wi lowered. Delta lobes alone keep theirs, as Surface::sample does.
HD inline RaisedDirection lowered(const Surface& surface, Vec3 wi_local) {
    if (!(surface.tilt > 0) || surface.bsdf.has_delta_only()) return {wi_local, 1.0f};
    return lower_direction(wi_local, surface.tilt);
}
/// Delta lobes stand beside others that take the lowered direction: half of the samples are drawn for each.
HD inline bool is_split(const Surface& surface, const RaisedDirection& from) {
    return from.slope < 1 && surface.bsdf.has_delta() && !surface.bsdf.has_delta_only();
}
HD inline float factor(const Surface& surface, Vec3 wo, Vec3 wi, Vec3 wo_local, const RaisedDirection& from) {
    const float there = abs(dot(wo, surface.geometric_normal)), here = abs(dot(wi, surface.geometric_normal));
    return abs(from.direction.z) * there / (abs(wo_local.z) * here * from.slope);
}

} // namespace particle

/// Through a surface, a particle that came from `wi` comes to where the square of the refractive index is this; it was
/// `here`. Power is the same on both sides, radiance over n^2 (bsdf_sample.h) is power that arrives, over that square.
HD inline float squared_index_beyond(const Surface& surface, Vec3 wi, float here) {
    const float squared = square(surface.bsdf.base.dielectric.ior);
    return surface.frame.to_local(wi).z > 0 ? here * squared : here / squared;
}
/// The same, where it goes on along `wo`: `here` but where that is through glass.
HD inline float squared_index_along(const Surface& surface, Vec3 wi, Vec3 wo, float here) {
    const bool goes_through = surface.bsdf.base.kind == LobeKind::Dielectric && !surface.same_side(wo, wi);
    return goes_through ? squared_index_beyond(surface, wi, here) : here;
}

/// Power sent on per solid angle of `wo`, of 1 that came from `wi`, by the lobes of `classes`; and the density of
/// sample_adjoint() at wo. Both directions unit, world space. Delta lobes give nothing.
HD inline BsdfValue evaluate_adjoint(const Surface& surface, Vec3 wi, Vec3 wo, LobeClasses classes = kAllLobeClasses) {
    const Vec3 wo_local = surface.frame.to_local(wo), wi_local = surface.frame.to_local(wi);
    if (!surface.is_consistent(wo, wi, wo_local, wi_local)) return {};
    const RaisedDirection from = particle::lowered(surface, wi_local);
    if (!(from.slope > 0)) return {};
    const BsdfValue value = surface.bsdf.evaluate(from.direction, wo_local, classes);
    if (!(value.pdf > 0)) return {};
    return {particle::factor(surface, wo, wi, wo_local, from) * value.f,
            particle::is_split(surface, from) ? 0.5f * value.pdf : value.pdf};
}

/// Where a particle from `wi` (unit, world space) goes: the direction is in the sample's `wi`, its weight the factor of
/// the particle's power. pdf 0: absorbed. The weight of a bent normal is not bounded where wo nears its horizon.
HD inline BsdfSample sample_adjoint(const Surface& surface, Vec3 wi, float u_lobe, Vec2 u) {
    const Vec3 wi_local = surface.frame.to_local(wi);
    RaisedDirection from = particle::lowered(surface, wi_local);
    const bool splits = particle::is_split(surface, from), draws_delta = splits && u_lobe < 0.5f;
    if (splits) u_lobe = draws_delta ? 2.0f * u_lobe : 2.0f * u_lobe - 1.0f;
    if (draws_delta) from = {wi_local, 1.0f};
    if (!(from.slope > 0)) return {};

    BsdfSample sample = surface.bsdf.sample(from.direction, u_lobe, u);
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
