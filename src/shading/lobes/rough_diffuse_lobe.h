#pragma once

// Rough diffuse reflection: Oren and Nayar's model as Fujii simplified it, with a second lobe that returns the light of
// further bounces, so that a white surface returns all light at every roughness. Roughness 0 is diffuse_lobe.h.
//
// Source: Portsmouth, Kutz & Hill, "EON: A practical energy-preserving rough diffuse BRDF", JCGT 14(1), 2025: value by
// section 3, with the exact albedo; sampling by section 5, a mix of uniform directions and a clipped, linearly
// transformed cosine.

#include "base/host_device.h"
#include "math/portable_math.h"
#include "math/sampling.h"
#include "math/vec2.h"
#include "shading/lobes/layer_transmittance.h"

namespace pertev {

struct RoughDiffuseLobe {
    Rgb albedo;      // [0, 1] per channel, of one bounce
    float share;     // factor on the light, [0, 1]
    float roughness; // (0, 1]

    HD LobeClass lobe_class() const { return LobeClass::Diffuse; }
    HD float energy() const { return share * max_component(albedo); }
    /// Mean reflectance of light from all directions.
    HD Rgb average_albedo() const {
        const float once = average_once();
        return share * (once * albedo + (1.0f - once) * tint_of_more(once));
    }

    HD_CALL BsdfValue evaluate(Vec3 wo, Vec3 wi, const LayerTransmittance& transmittance) const {
        if (!(wo.z * wi.z > 0)) return {};
        const Vec3 o = {wo.x, wo.y, abs(wo.z)}, i = {wi.x, wi.y, abs(wi.z)};
        const float along = o.x * i.x + o.y * i.y;
        const float bend = along > 0 ? along / max(o.z, i.z) : along;
        const float once = average_once(), flat = 1.0f / (1.0f + kFlat * roughness);
        const float more = (1.0f - albedo_of_one(o.z)) * (1.0f - albedo_of_one(i.z)) / max(1.0f - once, 1e-7f);
        const Rgb color = flat * (1.0f + roughness * bend) * albedo + more * tint_of_more(once);
        return {(transmittance.light * light_through(transmittance) * share * (i.z * kInvPi)) * color,
                transmittance.reach * pdf(o, i)};
    }
    HD_CALL LobeDraw draw(Vec3 wo, float u_lobe, Vec2 u) const {
        const Vec3 o = {wo.x, wo.y, abs(wo.z)};
        Vec3 wi;
        if (u_lobe < uniform_share(o.z)) {
            const float across = safe_sqrt(u.y * (2.0f - u.y));
            float sin_phi, cos_phi;
            sin_cos_2pi(u.x, sin_phi, cos_phi);
            wi = {across * cos_phi, across * sin_phi, 1.0f - u.y};
        } else {
            wi = Transform(o, roughness).draw(u);
        }
        if (!(wi.z > 0)) return {};
        wi.z = copysign(wi.z, wo.z);
        return draw_direction(wi);
    }

private:
    static constexpr float kFlat = 0.28779341f;    // 1/2 - 2 / (3 pi)
    static constexpr float kAverage = 0.07248821f; // 2/3 - 28 / (15 pi)

    /// The clipped cosine is cut out of a hemisphere and transformed by {{a, 0, b}, {0, c, 0}, {d, 0, 1}}, in a frame
    /// whose x is along the view.
    struct Transform {
        float a, b, c, d, cut;
        Vec2 along;

        HD Transform(Vec3 o, float r) {
            const float z = o.z;
            a = 1.0f + r * (0.303392f + (-0.518982f + 0.111709f * z) * z + (-0.276266f + 0.335918f * z) * r);
            b = r * (-1.16407f + 1.15859f * z + (0.150815f - 0.150105f * z) * r) / (z * z * z - 1.43545f);
            c = 1.0f + (0.20013f + (-0.506373f + 0.261777f * z) * z) * r;
            d = ((0.540852f + (-1.01625f + 0.475392f * z) * z) * r) / (-1.0743f + z * (0.0725628f + z));
            cut = 0.5f * (1.0f + 1.0f / sqrt(d * d + 1.0f));
            const float across2 = o.x * o.x + o.y * o.y;
            along = {1, 0};
            if (!(across2 > 1e-20f)) return;
            const float inv = 1.0f / sqrt(across2);
            along = {inv * o.x, inv * o.y};
        }
        HD Vec3 draw(Vec2 u) const {
            float sin_phi, cos_phi;
            sin_cos_2pi(u.y, sin_phi, cos_phi);
            const float radius = sqrt(u.x), y = radius * sin_phi;
            const float x = -lerp(safe_sqrt(1.0f - y * y), radius * cos_phi, cut);
            const float z = safe_sqrt(1.0f - x * x - y * y);
            const Vec3 w = {a * x + b * z, c * y, d * x + z};
            return normalize(Vec3{along.x * w.x - along.y * w.y, along.y * w.x + along.x * w.y, w.z});
        }
        HD float pdf(Vec3 i) const {
            const Vec3 w = {along.x * i.x + along.y * i.y, along.x * i.y - along.y * i.x, i.z};
            const Vec3 h = {c * (w.x - b * w.z), (a - b * d) * w.y, c * (a * w.z - d * w.x)};
            const float size = c * (a - b * d) / length_squared(h);
            return size * size * max(h.z, 0.0f) * kInvPi / cut;
        }
    };

    /// Reflectance of a white surface by one bounce, seen at cosine `z`.
    HD float albedo_of_one(float z) const {
        const float s = safe_sqrt(1.0f - z * z);
        const float g =
            s * (acos(min(z, 1.0f)) - s * z) + (2.0f / 3.0f) * (s * z * (1.0f + s + s * s) / (1.0f + s) - s);
        return (1.0f + roughness * kInvPi * g) / (1.0f + kFlat * roughness);
    }
    HD float average_once() const { return (1.0f + kAverage * roughness) / (1.0f + kFlat * roughness); }
    HD Rgb tint_of_more(float once) const {
        const auto of = [&](float a) { return a * a * once / (1.0f - a * (1.0f - once)); };
        return {of(albedo.r), of(albedo.g), of(albedo.b)};
    }
    /// Probability of a uniform direction.
    HD float uniform_share(float z) const {
        const float root = sqrt(sqrt(sqrt(roughness)));
        return root * (0.162925f + z * (-0.372058f + (0.538233f - 0.290822f * z) * z));
    }
    HD float pdf(Vec3 o, Vec3 i) const {
        const float uniform = uniform_share(o.z);
        return uniform * (0.5f * kInvPi) + (1.0f - uniform) * Transform(o, roughness).pdf(i);
    }
    /// A layer that expects a base after Lambert (layer_transmittance.h) would pass up to 0.7 % more to this one than
    /// there is.
    HD float light_through(const LayerTransmittance& above) const {
        if (!(above.average < 1)) return above.near * above.far;
        return above.near * above.far / above.average * (1.0f - 0.008f * roughness);
    }
};

} // namespace pertev
