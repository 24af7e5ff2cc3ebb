#include <array>

#include "formats/described/disney.h"
#include "formats/pbrt/colors.h"
#include "formats/pbrt/materials.h"
#include "math/portable_math.h"

namespace pertev::pbrt {
namespace {

using M = MaterialParameters;

constexpr std::array<std::string_view, 13> kVersion3Types = {
    "matte",       "plastic", "glass",   "metal",        "mirror",     "substrate", "uber",
    "translucent", "disney",  "fourier", "kdsubsurface", "subsurface", "hair"};

constexpr float kReflectanceOf15 = 0.04f; // at 0 degrees, for an index of 1.5

Surface matte(const MaterialSource& source) {
    Surface surface = make_surface(MaterialKind::Diffuse);
    set_color(surface, &M::base_color, &M::base_color_texture,
              source.textures.color(source.parameters, "Kd", grey(0.5f)));
    const TextureValue sigma = source.textures.number(source.parameters, "sigma", 0);
    if (sigma.has_image()) {
        source.parameters.leave_out({"sigma"}, "it has no texture", source.context.sink);
    } else if (sigma.factor.r > 0) {
        surface.material.base_diffuse_roughness = clamp(sigma.factor.r / 90, 0.0f, 1.0f);
        warn_of_nearest(source, "a rough diffuse surface of EON");
    }
    return surface;
}

/// Reads Kd, the albedo of a diffuse surface beneath a coat that reflects `share` of what its index says. pbrt-v4's own
/// upgrade of such materials makes coateddiffuse of them, which is darker and more saturated by the light that the coat
/// sends back.
void set_diffuse_beneath(const MaterialSource& source, float missing, float share, Surface& surface) {
    set_color(surface, &M::base_color, &M::base_color_texture,
              source.textures.color(source.parameters, "Kd", grey(missing)), Curve::BeneathCoat,
              share * reflected_inside(surface.material.ior));
}

/// Sets a diffuse surface and a reflection of Fresnel's reflectance times `ks`.
void set_plastic(const MaterialSource& source, const TextureValue& ks, Surface& surface) {
    const float most = ks.has_image() ? 1.0f : max_component(ks.factor);
    set_diffuse_beneath(source, 0.25f, ks.has_image() ? 0.5f : most, surface);
    surface.material.specular_weight = most;
    if (most > 0) set_color(surface, &M::specular_color, &M::specular_color_texture, ks.scaled(grey(1 / most)));
}

Surface plastic(const MaterialSource& source) {
    Surface surface = make_surface(MaterialKind::MetallicRoughness);
    read_roughness(source, 0.1, "", surface);
    set_plastic(source, source.textures.color(source.parameters, "Ks", grey(0.25f)), surface);
    warn_of_nearest(source, "a diffuse surface beneath a coat");
    return surface;
}

Surface substrate(const MaterialSource& source) {
    Surface surface = make_surface(MaterialKind::MetallicRoughness);
    read_roughness(source, 0.1, "", surface);
    // Ks is the reflectance at 0 degrees; the coat has the index of its mean.
    const TextureValue ks = source.textures.color(source.parameters, "Ks", grey(0.5f));
    const float mean =
        ks.has_image() ? kReflectanceOf15 : clamp((ks.factor.r + ks.factor.g + ks.factor.b) / 3, 1e-4f, 0.9f);
    surface.material.ior = (1 + sqrt(mean)) / (1 - sqrt(mean));
    set_color(surface, &M::specular_color, &M::specular_color_texture, ks.scaled(grey(1 / mean)));
    set_diffuse_beneath(source, 0.5f, 1, surface);
    warn_of_nearest(source, "a diffuse surface beneath a coat");
    return surface;
}

void set_index(const MaterialSource& source, float least, Surface& surface) {
    const char* const name = source.parameters.contains("eta") ? "eta" : "index";
    source.parameters.ignore({"eta", "index"});
    const TextureValue index = source.textures.number(source.parameters, name, 1.5f);
    if (index.has_image()) source.parameters.leave_out({name}, "it has no texture; 1.5 is used", source.context.sink);
    surface.material.ior = index.has_image() ? 1.5f : usable_ior(index.factor.r, least, 1.5f, source);
}

Surface glass(const MaterialSource& source) {
    Surface surface = make_surface(MaterialKind::Dielectric);
    set_index(source, kLeastIor, surface);
    surface.material.has_relative_ior = true;
    read_glass_roughness(source, surface);
    set_color(surface, &M::base_color, &M::base_color_texture, source.textures.color(source.parameters, "Kt", grey(1)));
    const TextureValue kr = source.textures.color(source.parameters, "Kr", grey(1));
    if (kr.has_image() || !(kr.factor == grey(1)))
        source.parameters.leave_out({"Kr"}, "the reflectance of glass follows from its index", source.context.sink);
    return surface;
}

Surface metal(const MaterialSource& source) {
    Surface surface = make_surface(MaterialKind::Conductor);
    const ComplexIndex copper = find_metal_index("Cu").value_or(ComplexIndex{});
    const auto usable = [](Rgb index, float least) {
        return Rgb{clamp(index.r, least, 0x1p10f), clamp(index.g, least, 0x1p10f), clamp(index.b, least, 0x1p10f)};
    };
    surface.material.eta =
        usable(index_of_channels(source.parameters, "eta", source.context).value_or(copper.eta), 0x1p-10f);
    surface.material.k = usable(index_of_channels(source.parameters, "k", source.context).value_or(copper.k), 0);
    read_roughness(source, 0.01, "", surface);
    return surface;
}

Surface mirror(const MaterialSource& source) {
    Surface surface = make_surface(MaterialKind::MetallicRoughness);
    set_mirror(surface, source.textures.color(source.parameters, "Kr", grey(0.9f)));
    return surface;
}

/// Adds a smooth reflection Kr to a surface with another one, as a coat; coats reflect without colour.
void set_mirror_above(const MaterialSource& source, const TextureValue& kr, Surface& surface) {
    Material& material = surface.material;
    material.coat_ior = material.ior;
    set_number(surface, &M::coat_weight, &M::coat_texture, kr);
    if (!kr.has_image() && !(kr.factor.r == kr.factor.g && kr.factor.g == kr.factor.b))
        source.parameters.leave_out({"Kr"}, "beside Ks it has no colour; its mean is used", source.context.sink);
}

/// Adds a refraction Kt to a diffuse surface: of the light that the reflection lets through, the share of Kt in both
/// is refracted, and the colour is that of both.
void set_refraction(const MaterialSource& source, const TextureValue& kt, Surface& surface) {
    Material& material = surface.material;
    const Rgb sum = material.base_color + kt.factor;
    if (kt.has_image() || material.base_color_texture.has_image() || surface.by_normal) {
        source.parameters.leave_out({"Kt"}, "a refraction and a diffuse colour together have no textures",
                                    source.context.sink);
        return;
    }
    material.kind = MaterialKind::MetallicRoughness;
    material.thin_walled = false;
    material.transmission_weight =
        clamp((kt.factor.r + kt.factor.g + kt.factor.b) / (sum.r + sum.g + sum.b), 0.0f, 1.0f);
    material.base_color = {min(sum.r, 1.0f), min(sum.g, 1.0f), min(sum.b, 1.0f)};
}

/// Reads a material uber: Kd with a reflection Ks, mirrored Kr, refracted Kt and an opacity, most of which a surface
/// can have.
Surface uber(const MaterialSource& source) {
    Surface surface = make_surface(MaterialKind::MetallicRoughness);
    Parameters& parameters = source.parameters;
    set_index(source, 1, surface);
    read_roughness(source, 0.1, "", surface);
    const auto color = [&](const char* name, float missing) {
        return source.textures.color(parameters, name, grey(missing));
    };
    const auto is_there = [](const TextureValue& value) { return value.has_image() || !is_black(value.factor); };
    const TextureValue ks = color("Ks", 0.25f), kr = color("Kr", 0), kt = color("Kt", 0);
    const bool is_mirror = is_there(kr) && !is_there(ks);
    if (is_mirror) set_number(surface, &M::roughness, &M::roughness_texture, constant(grey(0)));
    if (is_mirror) surface.material.specular_roughness_anisotropy = 0;
    set_plastic(source, is_mirror ? kr : ks, surface);
    if (is_there(kr) && !is_mirror) set_mirror_above(source, kr, surface);
    if (is_there(kt)) set_refraction(source, kt, surface);
    set_alpha(surface, color("opacity", 1));
    const bool has_reflection = is_there(ks) || is_there(kr);
    if (surface.material.alpha == 0) surface.is_nothing = true; // light passes unchanged
    if ((has_reflection || is_there(kt)) && !surface.is_nothing)
        warn_of_nearest(source, "a diffuse surface beneath a coat");
    if (!has_reflection && !is_there(kt) && !surface.material.base_color_texture.has_image())
        surface.material.kind = MaterialKind::Diffuse;
    return surface;
}

Surface translucent(const MaterialSource& source) {
    Surface surface = make_surface(MaterialKind::MetallicRoughness);
    Parameters& parameters = source.parameters;
    const TextureValue kd = source.textures.color(parameters, "Kd", grey(0.25f));
    const TextureValue ks = source.textures.color(parameters, "Ks", grey(0.25f));
    const TextureValue reflect = source.textures.color(parameters, "reflect", grey(0.5f));
    const TextureValue transmit = source.textures.color(parameters, "transmit", grey(0.5f));
    read_roughness(source, 0.1, "", surface);
    const Rgb here = reflect.has_image() ? grey(0.5f) : reflect.factor,
              far = transmit.has_image() ? grey(0.5f) : transmit.factor;
    const float sum = max_component(here) + max_component(far), weight = sum > 0 ? max_component(far) / sum : 0.0f;
    Material& material = surface.material;
    material.diffuse_transmission_weight = weight;
    const auto over = [](float share) { return share > 0 ? 1 / share : 0.0f; };
    set_color(surface, &M::base_color, &M::base_color_texture, kd.scaled(over(1 - weight) * here));
    set_color(surface, &M::diffuse_transmission_color, &M::diffuse_transmission_color_texture,
              kd.scaled(over(weight) * far));
    set_color(surface, &M::specular_color, &M::specular_color_texture, ks.scaled(here));
    warn_of_nearest(source, "a sheet that transmits diffuse light alone");
    return surface;
}

Surface disney(const MaterialSource& source) {
    Surface surface = make_surface(MaterialKind::MetallicRoughness);
    Parameters& parameters = source.parameters;
    Material& material = surface.material;
    set_number(surface, &M::metallic, &M::metallic_texture, source.textures.number(parameters, "metallic", 0));
    set_number(surface, &M::roughness, &M::roughness_texture, source.textures.number(parameters, "roughness", 0.5f));
    const auto number = [&](const char* name, double missing) {
        return clamp(static_cast<float>(parameters.number(name, missing, source.context.sink)), 0.0f, 1.0f);
    };
    const float clearcoat = number("clearcoat", 0), gloss = number("clearcoatgloss", 1);
    set_disney_coat(material, clearcoat, gloss);
    material.transmission_weight = number("spectrans", 0);
    material.thin_walled = parameters.truth("thin", false, source.context.sink);
    material.has_relative_ior = material.transmits() && !material.thin_walled;
    set_index(source, material.has_relative_ior ? kLeastIor : 1, surface);
    set_disney_sheen(material, (1 - material.transmission_weight) * number("sheen", 0));
    const TextureValue color = source.textures.color(parameters, "color", grey(0.5f));
    const bool is_metal = material.metallic > 0 || material.metallic_texture.has_image();
    if (material.transmission_weight == 1 && !is_metal) { // two interfaces have the colour together
        set_color(surface, &M::base_color, &M::base_color_texture, color, Curve::Root);
    } else {
        set_disney_reflection(material, 1);
        set_disney_color(surface, color, material.roughness);
    }
    for (const char* const name :
         {"speculartint", "anisotropic", "sheentint", "scatterdistance", "flatness", "difftrans"})
        parameters.leave_out({name}, "the nearest material has none", source.context.sink);
    warn_of_nearest(source, "glTF's material of these parameters");
    return surface;
}

} // namespace

std::span<const std::string_view> version_3_materials() { return kVersion3Types; }

std::optional<Surface> read_version_3_material(const MaterialSource& source) {
    const std::string& type = source.type;
    if (type == "matte") return matte(source);
    if (type == "plastic") return plastic(source);
    if (type == "glass") return glass(source);
    if (type == "metal") return metal(source);
    if (type == "mirror") return mirror(source);
    if (type == "substrate") return substrate(source);
    if (type == "uber") return uber(source);
    if (type == "translucent") return translucent(source);
    if (type == "disney") return disney(source);
    if (type == "kdsubsurface" || type == "subsurface") return read_subsurface(source);
    return std::nullopt;
}

} // namespace pertev::pbrt
