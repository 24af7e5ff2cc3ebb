#pragma once

// GGX microfacets of two widths: the surface's normals are stretched along one tangent and squeezed along the other.
// Each function equals that of ggx.h where both widths are equal.
//
// Source: as ggx.h; Heitz 2014, section 5.4 (the slopes of a stretched distribution); KHR_materials_anisotropy.

#include "shading/lobes/ggx.h"

namespace pertev {

/// Widths along x and y of a frame that is turned about the normal.
struct GgxWidths {
    float x, y;          // [0, 1], both at least kSmoothAlpha unless the surface is smooth
    Vec2 along = {1, 0}; // unit: x of the turned frame, in the frame of the BSDF

    HD bool is_smooth() const { return !(min(x, y) >= kSmoothAlpha); }
    HD Vec3 turned(Vec3 w) const { return {along.x * w.x + along.y * w.y, along.x * w.y - along.y * w.x, w.z}; }
    HD Vec3 turned_back(Vec3 w) const { return {along.x * w.x - along.y * w.y, along.y * w.x + along.x * w.y, w.z}; }

    // The arguments of all functions below are in the turned frame.

    HD float normals(Vec3 h) const {
        const float t = square(h.x / x) + square(h.y / y) + h.z * h.z;
        return 1.0f / (kPi * x * y * (t * t));
    }
    HD float slope_length(Vec3 w) const { return sqrt(w.z * w.z + square(x * w.x) + square(y * w.y)); }
    HD Vec3 sample_visible_normal(Vec3 wo, Vec2 u) const {
        const Vec3 w = normalize(Vec3{x * wo.x, y * wo.y, wo.z});
        const float drop = u.y * (1.0f + w.z);
        const float s = safe_sqrt(drop * (2.0f - drop));
        float sin_phi, cos_phi;
        sin_cos_2pi(u.x, sin_phi, cos_phi);
        const Vec3 m = {x * (s * cos_phi + w.x), y * (s * sin_phi + w.y), (1.0f - u.y) * (1.0f + w.z)};
        const float length2 = length_squared(m);
        if (!(length2 > 0)) return {0, 0, 1};
        return (1.0f / sqrt(length2)) * m;
    }
    HD GgxReflection evaluate_reflection(Vec3 wo, Vec3 wi) const {
        const Vec3 sum = wo + wi;
        const Vec3 h = (1.0f / sqrt(length_squared(sum))) * sum;
        const float d = normals(h), so = slope_length(wo), si = slope_length(wi);
        return {d * wi.z / (2.0f * (so * wi.z + si * wo.z)), d / (2.0f * (wo.z + so)), min(abs(dot(wo, h)), 1.0f)};
    }
    HD float narrowest() const { return min(x, y); }
    HD float widest() const { return max(x, y); }
    /// Width of the isotropic surface whose lost energy stands for that of this one; what it adds to Schlick's weight
    /// for light at a cosine; and the factor on the lost energy, because an uneven surface loses less at grazing
    /// angles. They were found by comparing single scattering over widths and angles, so that nothing is gained.
    HD float energy_width() const { return x == y ? x : sqrt(x * y) * (1.0f - 0.16f * unevenness()); }
    HD float grazing_excess(float cosine) const { return unevenness() * max(0.045f - 0.9f * cosine, 0.0f); }
    HD float energy_factor(float cosine) const { return 1.0f - unevenness() * max(0.7f - 2.3f * cosine, 0.0f); }

private:
    HD float unevenness() const { return min(2.5f * (1.0f - narrowest() / widest()), 1.0f); }
};

/// Widths of KHR_materials_anisotropy: `alpha` across, and towards 1 with the square of `strength` along.
HD inline GgxWidths anisotropic_widths(float alpha, float strength, Vec2 along) {
    return {alpha + (1.0f - alpha) * (strength * strength), alpha, along};
}

} // namespace pertev
