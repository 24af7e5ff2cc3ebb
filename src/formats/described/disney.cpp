#include "formats/described/disney.h"

#include "formats/described/rough_coat.h"
#include "math/portable_math.h"

namespace pertev::described {
namespace {

/// Returns the reflectance of a smooth dielectric of an index >= 1 under a white sky.
float reflected_outside(float ior) {
    constexpr int kSteps = 64;
    float sum = 0;
    for (int i = 0; i < kSteps; ++i) {
        const float cosine = (static_cast<float>(i) + 0.5f) / kSteps;
        const float far = sqrt(1 - (1 - cosine * cosine) / (ior * ior));
        const float s = (cosine - ior * far) / (cosine + ior * far), p = (ior * cosine - far) / (ior * cosine + far);
        sum += 0.5f * (s * s + p * p) * 2 * cosine / kSteps;
    }
    return sum;
}

/// Returns the share of metal, which keep_usable() has not seen yet.
float metallic_of(const Material& material) { return clamp(material.metallic, 0.0f, 1.0f); }

} // namespace

void set_disney_reflection(Material& material, float weight) {
    material.specular_weight = weight;
    if (!(material.ior >= 1)) return;
    const float root = (material.ior - 1) / (material.ior + 1), f0 = root * root;
    // The average of Schlick's weight is 1 / 21.
    const float grazing = min(f0 + 21 * (reflected_outside(material.ior) - f0), 1.0f);
    constexpr float kLeast = 1e-3f; // a reflection as weak as that is none
    material.specular_weight = grazing < kLeast ? 0.0f : weight * grazing;
    if (grazing >= kLeast) material.specular_color = grey(1 / grazing);
}

void set_disney_color(Surface& surface, const TextureValue& color, float roughness) {
    using M = MaterialParameters;
    Material& material = surface.material;
    const float opaque =
        material.metallic_texture.has_image() ? 0.0f : (1 - metallic_of(material)) * (1 - material.transmission_weight);
    float wanted = 1, ours = 1;
    if (opaque > 0) {
        // Disney's rough surfaces are brighter than Lambert's.
        const float rough = material.roughness_texture.has_image() ? 0.5f : clamp(roughness, 0.0f, 1.0f);
        wanted = 1 + opaque * (0.1123f * rough - 0.0471f);
        ours = 1 - opaque * (1 - passed_by_reflection(material));
    }
    float factor = wanted / ours;
    if (color.has_image() && factor > 1 && factor < 1.02f) factor = 1; // brightened images take four times the memory
    set_color(surface, &M::base_color, &M::base_color_texture, color.scaled(grey(factor)));
    Rgb& c = material.base_color;
    c = {min(c.r, 1.0f), min(c.g, 1.0f), min(c.b, 1.0f)};
}

void set_disney_coat(Material& material, float clearcoat, float gloss) {
    material.coat_weight = 0.25f * clearcoat;
    material.coat_roughness = sqrt(lerp(0.1f, 0.001f, gloss));
}

void set_disney_sheen(Material& material, float sheen) {
    // Disney's value is (1 - cos d)^5 cos, d half the angle between both directions. With these numbers glTF's sheen
    // has the same albedo: the difference is 0.001 in the mean square over angles.
    material.fuzz_weight = 0.09f * (1 - metallic_of(material)) * sheen;
    material.fuzz_roughness = 0.35f;
}

} // namespace pertev::described
