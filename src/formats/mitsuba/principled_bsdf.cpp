#include <algorithm>
#include <cmath>

#include "formats/described/disney.h"
#include "formats/described/make_surface.h"
#include "formats/mitsuba/bsdfs.h"
#include "math/portable_math.h"

namespace pertev::mitsuba {
namespace {

using M = MaterialParameters;

} // namespace

Surface Bsdfs::principled(Object& bsdf) {
    Sink& sink = reading_.sink();
    Parameters& parameters = bsdf.parameters;
    const bool is_thin = bsdf.type == "principledthin";
    Surface surface = make_surface(MaterialKind::MetallicRoughness);
    Material& material = surface.material;
    const auto number = [&](const char* name, float missing) {
        const TextureValue value = textures_.number(bsdf, name, missing);
        if (!value.has_image()) return clamp(value.factor.r, 0.0f, 1.0f);
        parameters.leave_out({name}, "it has no texture", sink);
        return missing;
    };
    set_number(surface, &M::roughness, &M::roughness_texture, textures_.number(bsdf, "roughness", 0.5f));
    const float roughness = material.roughness; // before it is that of the narrower width
    if (!is_thin) set_number(surface, &M::metallic, &M::metallic_texture, textures_.number(bsdf, "metallic", 0));
    material.transmission_weight = number("spec_trans", 0);
    material.thin_walled = is_thin;
    material.has_relative_ior = !is_thin && material.transmits();
    if (parameters.contains("eta")) {
        material.ior = usable_ior(bsdf, ior_of(bsdf, "eta", 1.5f), material.has_relative_ior ? kLeastIor : 1, 1.5f);
    } else { // 0.5 is the index of 1.5
        const float root = sqrt(0.08f * number("specular", 0.5f));
        material.ior = 2 / (1 - min(root, 0.99f)) - 1;
    }
    const float stretched = number("anisotropic", 0); // the widths are r^2 / a and r^2 a, a = sqrt(1 - 0.9 x)
    if (stretched > 0 && material.roughness_texture.has_image()) {
        parameters.leave_out({"anisotropic"}, "anisotropy is ignored for textured roughness", sink);
    } else if (stretched > 0) {
        const float a = sqrt(1 - 0.9f * stretched), width = material.roughness * material.roughness;
        set_roughness(surface, constant(grey(max(width / a, 1e-3f))), constant(grey(max(width * a, 1e-3f))),
                      Curve::RoughnessOfWidth);
    }
    if (is_thin) {
        material.diffuse_transmission_weight =
            0.5f * clamp(static_cast<float>(parameters.number("diff_trans", 0, sink)), 0.0f, 2.0f);
        set_color(surface, &M::diffuse_transmission_color, &M::diffuse_transmission_color_texture,
                  color(bsdf, "base_color", 0.5f));
    } else {
        const float clearcoat = number("clearcoat", 0), gloss = number("clearcoat_gloss", 0);
        set_disney_coat(material, clearcoat, gloss);
    }
    set_disney_sheen(material, number("sheen", 0));
    const bool is_clear = material.transmission_weight == 1 && material.metallic == 0;
    const TextureValue base = color(bsdf, "base_color", 0.5f);
    if (is_clear && !is_thin && !material.metallic_texture.has_image()) { // two interfaces have the colour together
        set_color(surface, &M::base_color, &M::base_color_texture, base, Curve::Root);
    } else {
        // A thin wall reflects only as far as it is clear.
        set_disney_reflection(material, is_thin ? material.transmission_weight : 1.0f);
        set_disney_color(surface, base, roughness);
    }
    for (const char* const name : {"spec_tint", "sheen_tint", "flatness"}) {
        const TextureValue value = textures_.number(bsdf, name, 0);
        if (value.has_image() || value.factor.r > 0)
            parameters.leave_out({name}, "the nearest material has none", sink);
    }
    parameters.ignore({"main_specular_sampling_rate", "clearcoat_sampling_rate", "diffuse_reflectance_sampling_rate",
                       "spec_reflectance_sampling_rate", "spec_trans_sampling_rate", "specular_sampling_rate",
                       "diffuse_sampling_rate", "diff_trans_sampling_rate"});
    warn_of_nearest(bsdf, "glTF's material of these parameters");
    return surface;
}

} // namespace pertev::mitsuba
