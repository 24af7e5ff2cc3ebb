#pragma once

// The surface of a pixel as a receiver of light from reservoirs' points, with the direction to its viewer. Where all
// materials are diffuse it is 64 bytes, and each pixel stores it once a frame: making it again from a hit takes longer
// than all that is done with it, and its pixel and the neighbours would do so eight times.

#include "device_scene/surface.h"
#include "render/scatter_calls.h"
#include "shading/shadow_terminator.h"

namespace pertev {

template <ShadingVariant kVariant>
struct Receiver {
    Surface surface;
    Vec3 wo; // unit

    HD Vec3 position() const { return surface.position; }
    HD LightContext light_context() const { return surface.light_context(wo); }
    /// Returns whether the surface scatters no light that comes from a point on a light.
    HD bool is_dark() const { return surface.is_unlit || surface.bsdf.has_delta_only(); }
    HD BsdfValue evaluate(Vec3 wi, LobeClasses classes = kAllLobeClasses) const {
        return evaluate_surface<kVariant>(surface, wo, wi, classes);
    }
    HD Rgb diffuse_share(Vec3 wi) const { return diffuse_share_at<kVariant>(surface, wo, wi); }
};

template <>
struct alignas(16) Receiver<ShadingVariant::Diffuse> {
    Vec3 at; // translated world
    float tilt;
    Vec3 geometric_normal; // unit, on the viewer's side
    float unused = 0;
    Vec3 normal; // unit, on the viewer's side; zero if it is perpendicular to wo
    float unused_too = 0;
    Rgb albedo;
    float unused_again = 0;

    HD Vec3 position() const { return at; }
    HD LightContext light_context() const { return {at, normal, false, kAtRest}; }
    HD bool is_dark() const { return false; }
    /// Returns the value of Surface::evaluate for this surface.
    HD BsdfValue evaluate(Vec3 wi, LobeClasses = kAllLobeClasses) const {
        const float cosine = dot(wi, normal);
        if (!(cosine > 0 && dot(wi, geometric_normal) > 0)) return {};
        const DiffuseLobe lobe = {albedo, 1};
        const Vec3 up = {0, 0, 1}, local = {0, 0, cosine}; // only the height matters
        if (!(tilt > 0)) return lobe.evaluate(up, local, {});
        const RaisedDirection from = lower_direction(local, tilt);
        if (!(from.slope > 0)) return {};
        const BsdfValue value = lobe.evaluate(up, from.direction, {});
        return {(1.0f / from.slope) * value.f, value.pdf / from.slope};
    }
    HD Rgb diffuse_share(Vec3) const { return {1, 1, 1}; }
};
using DiffuseReceiver = Receiver<ShadingVariant::Diffuse>;
static_assert(sizeof(DiffuseReceiver) == 64);

HD inline DiffuseReceiver diffuse_receiver(const Surface& surface, Vec3 wo) {
    const auto towards = [&](Vec3 normal) { return dot(wo, normal) > 0 ? normal : -normal; };
    const Vec3 normal = surface.frame.normal;
    return {.at = surface.position,
            .tilt = surface.tilt,
            .geometric_normal = towards(surface.geometric_normal),
            .normal = dot(wo, normal) == 0 ? Vec3{0, 0, 0} : towards(normal),
            .albedo = surface.bsdf.base.diffuse.albedo};
}

} // namespace pertev
