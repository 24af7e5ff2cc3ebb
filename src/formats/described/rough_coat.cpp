#include "formats/described/rough_coat.h"

#include <array>

#include "formats/described/make_surface.h"
#include "math/portable_math.h"

namespace pertev::described {
namespace {

constexpr int kCosines = 16, kRings = 16, kTurns = 16;
constexpr float kSmoothWidth = 1e-4f;

struct Refraction {
    float reflectance;
    float cosine; // the refracted ray's; 0 without one
};
/// Fresnel's equations at a cosine > 0 for an index of the far side over the near one.
Refraction refract(float cosine, float eta) {
    const float square = 1 - (1 - cosine * cosine) / (eta * eta);
    if (!(square > 0)) return {1, 0};
    const float far = sqrt(square);
    const float s = (cosine - eta * far) / (cosine + eta * far), p = (eta * cosine - far) / (eta * cosine + far);
    return {0.5f * (s * s + p * p), far};
}

/// Microfacets of one width.
struct Facets {
    float width;
    bool is_beckmann;

    /// Share of the facets that a direction at this cosine > 0 sees (Smith; Beckmann's as Walter et al., equation 27).
    float seen(float z) const {
        const float across = width * safe_sqrt(1 - z * z);
        if (!is_beckmann) return 2 * z / (z + sqrt(z * z + across * across));
        const float a = z / max(across, 1e-9f);
        return a >= 1.6f ? 1 : a * (3.535f + 2.181f * a) / (1 + a * (2.276f + 2.577f * a));
    }
    /// Length of the slopes that the share `steeper` exceeds.
    float slope(float steeper) const {
        return width * (is_beckmann ? sqrt(-log(steeper)) : sqrt((1 - steeper) / steeper));
    }
};

/// Shares of the light at one cosine by what microfacets do with it.
struct Shares {
    float reflected, transmitted; // the rest is lost
    float schlick;                // the mean of Schlick's weight over what a reflectance of 1 reflects
};
Shares shares_at(const Facets& facets, float z, float eta) {
    const float x = safe_sqrt(1 - z * z);
    Shares sum = {};
    float all = 0, mirrored = 0;
    for (int ring = 0; ring < kRings; ++ring) {
        // The rings narrow towards the steepest slopes, which weigh most.
        const float share = (static_cast<float>(ring) + 0.5f) / kRings, r = facets.slope(share * share);
        for (int turn = 0; turn < kTurns; ++turn) { // half a turn, because the other half is its mirror image
            float sine, cosine;
            sin_cos_2pi(0.5f * (static_cast<float>(turn) + 0.5f) / kTurns, sine, cosine);
            const float mz = 1 / sqrt(1 + r * r), mx = r * cosine * mz;
            const float om = x * mx + z * mz, weight = share * om / mz;
            if (!(om > 0)) continue;
            all += weight;
            const Refraction at = refract(min(om, 1.0f), eta);
            const float up = 2 * om * mz - z;
            if (up > 0) {
                const float out = weight * facets.seen(min(up, 1.0f)), less = 1 - min(om, 1.0f);
                sum.reflected += out * at.reflectance;
                mirrored += out;
                sum.schlick += out * (less * less * less * less * less);
            }
            const float down = z / eta - (om / eta - at.cosine) * mz;
            if (at.cosine > 0 && down > 0)
                sum.transmitted += weight * facets.seen(min(down, 1.0f)) * (1 - at.reflectance);
        }
    }
    if (!(all > 0)) return {0, 0, 1};
    return {sum.reflected / all, sum.transmitted / all, mirrored > 0 ? sum.schlick / mirrored : 1.0f};
}

Facets facets_of(const Material& coat) {
    const float narrow = coat.roughness * coat.roughness;
    const float wide = lerp(narrow, 1.0f, square(coat.specular_roughness_anisotropy));
    const float width = coat.roughness_texture.has_image() ? 0.1f : max(sqrt(narrow * wide), 0.5f * wide);
    return {clamp(width, kSmoothWidth, 1.0f), coat.microfacet_distribution == MicrofacetDistribution::Beckmann};
}

} // namespace

float passed_by_reflection(const Material& coat) {
    const float root = (coat.ior - 1) / (coat.ior + 1), f90 = coat.specular_weight;
    const float f0 = f90 * min(root * root * max_component(coat.specular_color), 1.0f);
    const Facets facets = facets_of(coat);
    std::array<float, kCosines> reflected;
    for (int k = 0; k < kCosines; ++k) {
        const float z = (static_cast<float>(k) + 0.5f) / kCosines;
        reflected[static_cast<std::size_t>(k)] = f0 + (f90 - f0) * shares_at(facets, z, coat.ior).schlick;
    }
    const bool is_smooth = !(facets.width > kSmoothWidth) && coat.energy == MicrofacetEnergy::Compensated;
    float passed = 0;
    for (int i = 0; i < kCosines; ++i) {
        for (int o = 0; o < kCosines; ++o) {
            const float a = reflected[static_cast<std::size_t>(i)], b = reflected[static_cast<std::size_t>(o)];
            const float weight = (2 * static_cast<float>(i) + 1) * (2 * static_cast<float>(o) + 1);
            passed += weight * (is_smooth ? 1 - a : 1 - max(a, b));
        }
    }
    return passed / (static_cast<float>(kCosines) * kCosines * kCosines * kCosines);
}

CoatedBase base_of_coat(const Material& coat, CoatModel model) {
    const float n = coat.ior;
    const Facets facets = facets_of(coat);
    const float width = facets.width;
    float in = 0, lost_inside = 0;
    for (int k = 0; k < kCosines; ++k) {
        const float z = (static_cast<float>(k) + 0.5f) / kCosines, weight = 2 * z / kCosines;
        const Shares here = shares_at(facets, z, n);
        in += weight * here.transmitted;
        const Shares inwards = shares_at(facets, z, 1 / n);
        lost_inside += weight * (1 - inwards.reflected - inwards.transmitted);
    }
    // By reciprocity the share in / n^2 leaves. This sum is smoother than that of what is reflected totally or not.
    float inside = max(1 - in / (n * n) - lost_inside, 0.0f);
    if (model == CoatModel::Mitsuba && width > kSmoothWidth)
        inside = (63 * inside + shares_at(facets, 1, 1 / n).reflected) / 64; // its mean of 64 rows, both ends in full
    return {in * in / (n * n * (1 - inside)) / passed_by_reflection(coat), inside};
}

void set_coated_color(Surface& surface, const TextureValue& color, CoatModel model, bool is_dyed) {
    using M = MaterialParameters;
    Material& material = surface.material;
    if (!(material.roughness > 0) && !material.has_anisotropy() && !material.roughness_texture.has_image()) {
        // A smooth coat loses nothing, and only so its base has the shape over the angle that it has there.
        material.microfacet_distribution = MicrofacetDistribution::Ggx;
        material.energy = MicrofacetEnergy::Compensated;
    }
    const CoatedBase base = base_of_coat(material, model);
    if (!is_dyed) {
        set_color(surface, &M::base_color, &M::base_color_texture, color.scaled(grey(base.factor)));
        Rgb& c = material.base_color;
        c = {min(c.r, 1.0f), min(c.g, 1.0f), min(c.b, 1.0f)};
        return;
    }
    // With s = inside + (1 - inside) factor: factor c (1 - inside) / (1 - c inside) is the curve's of s c and inside /
    // s.
    const float scale = base.inside + (1 - base.inside) * base.factor;
    set_color(surface, &M::base_color, &M::base_color_texture, color.scaled(grey(scale)), Curve::BeneathCoat,
              base.inside / scale);
}

} // namespace pertev::described
