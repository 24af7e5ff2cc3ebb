#include "formats/described/make_surface.h"

#include "math/portable_math.h"

namespace pertev::described {
namespace {

using M = MaterialParameters;

} // namespace

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

void tint_thin_pane(Surface& surface, const TextureValue& reflected, const TextureValue& transmitted) {
    Material& material = surface.material;
    const float most = reflected.has_image() ? 1.0f : clamp(max_component(reflected.factor), 0.0f, 1.0f);
    material.specular_weight = most;
    if (most > 0) set_color(surface, &M::specular_color, &M::specular_color_texture, reflected.scaled(grey(1 / most)));
    // The wall transmits all but what it reflects; there, the untinted reflection is lost.
    const float root = (material.ior - 1) / (material.ior + 1), whole = root * root;
    const float rest = (1 - whole) / (1 - most * whole);
    set_color(surface, &M::base_color, &M::base_color_texture, transmitted.scaled(grey(rest)));
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

void set_coat_roughness(Surface& surface, const Surface& reflection) {
    Material& material = surface.material;
    const Material& from = reflection.material;
    material.coat_roughness = from.roughness;
    material.coat_roughness_texture = from.roughness_texture;
    material.coat_roughness_anisotropy = from.specular_roughness_anisotropy;
    material.coat_anisotropy_rotation = from.anisotropy_rotation;
    std::erase_if(surface.images, [](const SlotImage& use) { return use.slot == &M::coat_roughness_texture; });
    for (SlotImage image : reflection.images) {
        if (image.slot != &M::roughness_texture) continue;
        image.slot = &M::coat_roughness_texture;
        surface.images.push_back(image);
    }
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

} // namespace pertev::described
