#pragma once

// Microfacets of two widths: the surface's normals are stretched along one tangent and squeezed along the other, after
// GGX or Beckmann, with or without the energy of further bounces. With GGX each function equals that of ggx.h where
// both widths are equal.
//
// Source: as ggx.h and beckmann.h; Heitz 2014, section 5.4 (the slopes of a stretched distribution);
// KHR_materials_anisotropy.

#include "shading/lobes/beckmann.h"
#include "shading/lobes/energy_tables.h"
#include "shading/lobes/ggx.h"
#include "shading/lobes/grazing_lobe.h"
#include "shading/lobes/stretched_tables.h"

namespace pertev {

/// Widths along x and y of a frame that is turned about the normal.
struct Microfacets {
    float x, y;          // [0, 1], both at least kSmoothAlpha unless the surface is smooth
    Vec2 along = {1, 0}; // unit: x of the turned frame, in the frame of the BSDF
    bool is_beckmann = false;
    bool is_single = false; // no light of further bounces

    HD bool is_smooth() const { return !(min(x, y) >= kSmoothAlpha); }
    HD Vec3 turned(Vec3 w) const { return {along.x * w.x + along.y * w.y, along.x * w.y - along.y * w.x, w.z}; }
    HD Vec3 turned_back(Vec3 w) const { return {along.x * w.x - along.y * w.y, along.y * w.x + along.x * w.y, w.z}; }

    // The arguments of all functions below but sample_reflection() are in the turned frame.

    HD float normals(Vec3 h) const {
        if (is_beckmann) {
            const float z2 = h.z * h.z;
            if (!(z2 > 1e-6f)) return 0;
            return exp(-(square(h.x / x) + square(h.y / y)) / z2) / (kPi * x * y * (z2 * z2));
        }
        const float t = square(h.x / x) + square(h.y / y) + h.z * h.z;
        return 1.0f / (kPi * x * y * (t * t));
    }
    HD float slope_length(Vec3 w) const {
        const float across2 = square(x * w.x) + square(y * w.y);
        return is_beckmann ? beckmann::slope_length(abs(w.z), sqrt(across2)) : sqrt(w.z * w.z + across2);
    }
    HD_CALL Vec3 sample_visible_normal(Vec3 wo, Vec2 u) const {
        const Vec3 w = normalize(Vec3{x * wo.x, y * wo.y, wo.z});
        if (is_beckmann) {
            const Vec3 slopes = beckmann::sample_visible_normal(w, u);
            return normalize(Vec3{x * slopes.x, y * slopes.y, slopes.z});
        }
        const float drop = u.y * (1.0f + w.z);
        const float s = safe_sqrt(drop * (2.0f - drop));
        float sin_phi, cos_phi;
        sin_cos_2pi(u.x, sin_phi, cos_phi);
        const Vec3 m = {x * (s * cos_phi + w.x), y * (s * sin_phi + w.y), (1.0f - u.y) * (1.0f + w.z)};
        const float length2 = length_squared(m);
        if (!(length2 > 0)) return {0, 0, 1};
        return (1.0f / sqrt(length2)) * m;
    }
    /// Samples the direction of one reflection, in the frame of the BSDF with z upwards on the side of `wo`; z <= 0 if
    /// it is lost below the surface.
    HD Vec3 sample_reflection(Vec3 wo, Vec2 u) const {
        const Vec3 o = turned({wo.x, wo.y, abs(wo.z)});
        return normalize(turned_back(reflect(o, sample_visible_normal(o, u))));
    }
    HD_CALL GgxReflection evaluate_reflection(Vec3 wo, Vec3 wi) const {
        const Vec3 sum = wo + wi;
        const Vec3 h = (1.0f / sqrt(length_squared(sum))) * sum;
        const float d = normals(h), so = slope_length(wo), si = slope_length(wi);
        return {d * wi.z / (2.0f * (so * wi.z + si * wo.z)), d / (2.0f * (wo.z + so)), min(abs(dot(wo, h)), 1.0f)};
    }
    HD float narrowest() const { return min(x, y); }
    HD float widest() const { return max(x, y); }
    /// Width of the isotropic surface that loses about as much.
    HD float energy_width() const { return x == y ? x : sqrt(x * y) * (1.0f - 0.16f * unevenness()); }

    /// Fraction of the light that one bounce off a reflector with F = 1 loses and further bounces return, seen from
    /// `w`, and its average. Both are 0 for smooth and single scattering.
    HD_CALL float lost(Vec3 w) const {
        if (is_smooth() || is_single) return 0;
        if (x != y) return stretched_lost(w, x, y, is_beckmann);
        return is_beckmann ? beckmann_lost(w.z, x) : metal_lost(w.z, x);
    }
    HD_CALL float average_lost() const {
        if (is_smooth() || is_single) return 0;
        if (x != y) return stretched_average_lost(x, y, is_beckmann);
        return is_beckmann ? beckmann_average_lost(x) : metal_average_lost(x);
    }
    /// Average of Schlick's weight over the light that it reflects, seen from `w`: rather too much. Where the widths
    /// differ, it is at most that of the narrower one and what schlick_excess() adds.
    HD_CALL float schlick(Vec3 w) const {
        if (is_smooth()) return schlick_weight(w.z);
        const float narrow = is_beckmann ? beckmann_schlick(w.z, narrowest()) : metal_schlick(w.z, narrowest());
        return x == y ? narrow : min(narrow + schlick_excess(w), 1.0f);
    }
    /// lost() and average_lost() of glass. Beckmann's stretched glass is taken to lose the share of what an even one
    /// loses that metal has, and at most that; near the horizon less, by comparison over widths and angles.
    HD_CALL float glass_loss(Vec3 w, float eta) const {
        if (is_smooth() || is_single) return 0;
        if (has_glass_table()) return stretched_glass_lost(w, x, y, eta);
        const float width = energy_width(), cosine = min(abs(w.z), 1.0f);
        const float even = is_beckmann ? beckmann_glass_lost(cosine, width, eta) : glass_lost(cosine, width, eta);
        if (x == y) return even;
        const float metal = is_beckmann ? beckmann_lost(cosine, width) : metal_lost(cosine, width);
        const float horizon = 1.0f - unevenness() * max(0.95f - 3.1f * cosine, 0.0f);
        return even * min(lost(w) / max(metal, 1e-9f), horizon);
    }
    HD_CALL float average_glass_loss(float eta) const {
        if (has_glass_table()) return stretched_average_glass_lost(x, y, eta);
        const float width = energy_width();
        return is_beckmann ? beckmann_average_glass_lost(width, eta) : glass_average_lost(width, eta);
    }
    /// Samples a direction for that light, u in [0, 1)^2, and the density at a cosine, 1/sr.
    HD_CALL Vec3 sample_lost_lobe(Vec2 u, bool is_glass = false) const {
        const float width = lost_lobe_width(is_glass), own = share_of_own_lobe(is_glass);
        float z2;
        if (!is_beckmann && !is_glass) {
            z2 = sample_metal_lost(width, u.y);
        } else if (!(own < 1) || u.x < own) {
            z2 = beckmann::sample_lost_lobe(width, u.y);
            u.x = u.x / own;
        } else {
            z2 = sample_grazing_lobe(width, u.y);
            u.x = min((u.x - own) / (1.0f - own), 0x1.fffffep-1f);
        }
        return direction_of_squared_cosine(z2, u.x);
    }
    HD_CALL float pdf_lost_lobe(float cosine, bool is_glass = false) const {
        const float width = lost_lobe_width(is_glass), own = share_of_own_lobe(is_glass);
        if (!is_beckmann && !is_glass) return pdf_metal_lost(cosine, width);
        float pdf = 0;
        if (own > 0) pdf += own * beckmann::pdf_lost_lobe(cosine, width);
        if (own < 1) pdf += (1.0f - own) * pdf_grazing_lobe(cosine, width);
        return pdf;
    }

private:
    /// Returns how often Beckmann's own lobe is drawn for that light, else GGX's. Glass loses light at more angles.
    HD float share_of_own_lobe(bool is_glass) const {
        if (!is_beckmann) return 0;
        if (!is_glass) return x == y ? 1.0f : 0.7f;
        return energy_width() > 0.5f ? 0.0f : 0.5f;
    }
    /// Metal loses light up to the angles of the wider width, which has to be drawn there.
    HD float lost_lobe_width(bool is_glass) const {
        if (is_glass && has_glass_table()) return stretched_even_width(widest(), narrowest());
        return is_glass ? energy_width() : widest();
    }
    HD bool has_glass_table() const { return x != y && !is_beckmann; }
    /// Found by comparison over widths and angles: most across the tangent, where facets that face the wide way
    /// reflect.
    HD float schlick_excess(Vec3 w) const {
        const float a = square(x * w.x), b = square(y * w.y), most = x > y ? b : a;
        const float across = a + b > 0 ? most / (a + b) : 1.0f;
        return unevenness() * (schlick_weight(w.z) * (0.062f + 0.1f * across) + 0.012f * (1.0f - w.z));
    }
    HD float unevenness() const { return min(2.5f * (1.0f - narrowest() / widest()), 1.0f); }
};

/// Direction and strength of stretched highlights, in a BSDF's frame.
struct Stretch {
    Vec2 along = {1, 0};  // unit, the tangent along which they are
    float anisotropy = 0; // [0, 1]
};

/// Widths of KHR_materials_anisotropy: `alpha` across, and towards 1 with the square of `strength` along.
HD inline Microfacets anisotropic_widths(float alpha, float strength, Vec2 along) {
    return {alpha + (1.0f - alpha) * (strength * strength), alpha, along};
}

} // namespace pertev
