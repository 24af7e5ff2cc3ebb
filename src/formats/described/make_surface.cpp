#include "formats/described/make_surface.h"

#include "math/portable_math.h"

namespace pertev::described {
namespace {

using M = MaterialParameters;

/// Returns whether two diffuse surfaces without images differ in nothing but their colours.
bool looks_like_but_for_color(const Surface& a, const Surface& b) {
    return a.material.base_diffuse_roughness == b.material.base_diffuse_roughness &&
           a.material.alpha == b.material.alpha && a.has_heights == b.has_heights &&
           a.material.normal_texture.image == b.material.normal_texture.image &&
           a.material.alpha_texture.image == b.material.alpha_texture.image &&
           a.has_vertex_colors == b.has_vertex_colors;
}

} // namespace

std::string mixed_by_color(const std::string& mixture) {
    return "only the colours of the parts of " + mixture +
           " are mixed; their bumps, roughness, alpha and vertex colours are those of the first";
}

Surface make_surface(MaterialKind kind) {
    Surface surface;
    surface.material.kind = kind;
    surface.material.roughness = 0;
    surface.material.energy = MicrofacetEnergy::Single;
    surface.material.microfacet_distribution = MicrofacetDistribution::Ggx;
    return surface;
}

void set_mirror(Surface& surface, const TextureValue& color) {
    Material& material = surface.material;
    material.kind = MaterialKind::MetallicRoughness;
    material.metallic = 1;
    set_color(surface, &M::base_color, &M::base_color_texture, color);
    if (color.has_image()) return;
    // Schlick's colour rises towards grazing angles; the tint of F82 takes that off again.
    constexpr float kOneLessCosine = 1 - 1.0f / 7,
                    kRise = kOneLessCosine * kOneLessCosine * kOneLessCosine * kOneLessCosine * kOneLessCosine;
    const auto tint = [](float r) { return r / (r + (1 - r) * kRise); };
    material.metal_fresnel = MetalFresnel::F82;
    const Rgb c = material.base_color;
    material.specular_color = {tint(c.r), tint(c.g), tint(c.b)};
}

void set_thin_pane(Surface& surface) {
    Material& material = surface.material;
    const float root = (material.ior - 1) / (material.ior + 1), once = root * root;
    const float amplitude = sqrt(2 * once / (1 + once));
    material.ior = (1 + amplitude) / (1 - amplitude);
    material.base_color = grey(1);
    material.roughness = 0;
    material.transmission_weight = 1;
    material.thin_walled = true;
}

void set_roughness(Surface& surface, const TextureValue& u, const TextureValue& v, Curve curve) {
    Material& material = surface.material;
    if (u.has_image() || v.has_image()) {
        set_number(surface, &M::roughness, &M::roughness_texture, u.has_image() ? u : v, curve);
        return;
    }
    const float along = converted(curve, 0, u.factor.r), across = converted(curve, 0, v.factor.r);
    const float wide = max(along, across) * max(along, across), narrow = min(along, across) * min(along, across);
    material.roughness = min(along, across);
    if (!(wide > narrow) || narrow >= 1) return;
    material.specular_roughness_anisotropy = sqrt((wide - narrow) / (1 - narrow));
    material.anisotropy_rotation = along > across ? 0.0f : 0.5f * kPi;
}

float reflected_inside(float ior) {
    constexpr int kSteps = 256;
    float sum = 0; // the integral of F(cosine) 2 cosine, by the middles of equal steps
    for (int i = 0; i < kSteps; ++i) {
        const float cosine = (static_cast<float>(i) + 0.5f) / kSteps;
        const float square = 1 - ior * ior * (1 - cosine * cosine);
        float reflected = 1;
        if (square > 0) {
            const float out = sqrt(square);
            const float s = (ior * cosine - out) / (ior * cosine + out),
                        p = (cosine - ior * out) / (cosine + ior * out);
            reflected = 0.5f * (s * s + p * p);
        }
        sum += reflected * 2 * cosine / kSteps;
    }
    return sum;
}

MixedSurface mix_surfaces(const Surface& first, const Surface& second, const TextureValue& of_second) {
    if (first.is_nothing || second.is_nothing) {
        if (first.is_nothing && second.is_nothing) return {first, std::nullopt};
        Surface surface = first.is_nothing ? second : first;
        TextureValue alpha = of_second;
        if (second.is_nothing) {
            alpha = of_second.scaled(grey(-1));
            alpha.offset += grey(1);
            if (!alpha.has_image()) alpha = constant(grey(1 - of_second.factor.r));
        }
        set_alpha(surface, alpha);
        return {surface, std::nullopt};
    }
    const float share = of_second.has_image() ? 0.5f : clamp(of_second.factor.r, 0.0f, 1.0f);
    const bool is_diffuse = first.material.kind == MaterialKind::Diffuse &&
                            second.material.kind == MaterialKind::Diffuse && first.images.empty() &&
                            second.images.empty();
    const bool differs = !looks_like_but_for_color(first, second);
    if (is_diffuse && !of_second.has_image()) {
        Surface surface = first;
        surface.material.base_color = lerp(first.material.base_color, second.material.base_color, share);
        return {surface, std::nullopt, differs};
    }
    if (is_diffuse) {
        Surface surface = first;
        TextureValue color = of_second.scaled(second.material.base_color - first.material.base_color);
        color.offset += first.material.base_color;
        set_color(surface, &M::base_color, &M::base_color_texture, color);
        return {surface, std::nullopt, differs};
    }
    MixedSurface mixed{share < 0.5f ? first : second, std::nullopt};
    if (share > 0 && share < 1) mixed.left_out = share < 0.5f ? 1 : 0;
    return mixed;
}

} // namespace pertev::described
