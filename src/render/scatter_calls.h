#pragma once

// Scattering at a surface for stages of many integrators: device code calls these functions where materials have lobes,
// so that a kernel contains each once and compiles in a fraction of the time. Path tracing inlines
// Surface::evaluate and Surface::sample instead, which is faster.

#include "render/particle_scatter.h"
#include "shading/assume_variant.h"

namespace pertev {

namespace scatter_call { // the surface is in memory for the call already

template <ShadingVariant kVariant>
HD_CALL inline BsdfValue evaluate(const Surface& surface, Vec3 wo, Vec3 wi, LobeClasses classes) {
    assume_variant<kVariant>(surface.bsdf);
    return surface.evaluate<BsdfPass::InPlace>(wo, wi, classes);
}
template <ShadingVariant kVariant>
HD_CALL inline BsdfSample sample(const Surface& surface, Vec3 wo, float u_lobe, Vec2 u) {
    assume_variant<kVariant>(surface.bsdf);
    return surface.sample<BsdfPass::InPlace>(wo, u_lobe, u);
}
template <ShadingVariant kVariant>
HD_CALL inline BsdfValue evaluate_particle(const Surface& surface, Vec3 wi, Vec3 wo) {
    assume_variant<kVariant>(surface.bsdf);
    return evaluate_adjoint<BsdfPass::InPlace>(surface, wi, wo);
}
template <ShadingVariant kVariant>
HD_CALL inline BsdfSample sample_particle(const Surface& surface, Vec3 wi, float u_lobe, Vec2 u) {
    assume_variant<kVariant>(surface.bsdf);
    return sample_adjoint<BsdfPass::InPlace>(surface, wi, u_lobe, u);
}

} // namespace scatter_call

/// Returns Surface::evaluate() of `wi`, called or inlined by the variant.
template <ShadingVariant kVariant>
HD inline BsdfValue evaluate_surface(const Surface& surface, Vec3 wo, Vec3 wi, LobeClasses classes = kAllLobeClasses) {
    if constexpr (has_lobes(kVariant)) return scatter_call::evaluate<kVariant>(surface, wo, wi, classes);
    assume_variant<kVariant>(surface.bsdf);
    return surface.evaluate(wo, wi, classes);
}
/// Returns Surface::diffuse_share() of `wi`.
template <ShadingVariant kVariant>
HD inline Rgb diffuse_share_at(const Surface& surface, Vec3 wo, Vec3 wi) {
    assume_variant<kVariant>(surface.bsdf);
    return surface.diffuse_share(wo, wi);
}
/// Returns the sample of Surface::sample.
template <ShadingVariant kVariant>
HD inline BsdfSample sample_surface(const Surface& surface, Vec3 wo, float u_lobe, Vec2 u) {
    if constexpr (has_lobes(kVariant)) return scatter_call::sample<kVariant>(surface, wo, u_lobe, u);
    assume_variant<kVariant>(surface.bsdf);
    return surface.sample(wo, u_lobe, u);
}
/// Returns the value of evaluate_adjoint().
template <ShadingVariant kVariant>
HD inline BsdfValue evaluate_particle(const Surface& surface, Vec3 wi, Vec3 wo) {
    if constexpr (has_lobes(kVariant)) return scatter_call::evaluate_particle<kVariant>(surface, wi, wo);
    assume_variant<kVariant>(surface.bsdf);
    return evaluate_adjoint(surface, wi, wo);
}
/// Returns the sample of sample_adjoint().
template <ShadingVariant kVariant>
HD inline BsdfSample sample_particle(const Surface& surface, Vec3 wi, float u_lobe, Vec2 u) {
    if constexpr (has_lobes(kVariant)) return scatter_call::sample_particle<kVariant>(surface, wi, u_lobe, u);
    assume_variant<kVariant>(surface.bsdf);
    return sample_adjoint(surface, wi, u_lobe, u);
}

} // namespace pertev
