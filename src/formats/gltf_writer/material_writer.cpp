#include "formats/gltf_writer/material_writer.h"

#include <array>

#include <fmt/format.h>

#include "base/json_text.h"
#include "math/scalar.h"

namespace pertev::glb {
namespace {

std::string json_of(Rgb c) { return json_floats(std::array{c.r, c.g, c.b}); }

/// Writes one material.
class Writer {
public:
    Writer(const Material& material, const std::string& owner, TextureWriter& textures, GlbParts& parts, Sink& sink)
        : m_(material), owner_(owner), textures_(textures), parts_(parts), sink_(sink) {}

    std::string text() {
        name_losses();
        JsonMembers members;
        if (!m_.name.empty()) members.add("name", json_string(m_.name));
        members.add("pbrMetallicRoughness", metallic_roughness());
        add_texture(members, "normalTexture", textures_.info(m_.normal_texture, false, owner_, scale(m_.normal_scale)));
        add_emission(members);
        if (m_.alpha_mode != AlphaMode::Opaque)
            members.add("alphaMode", m_.alpha_mode == AlphaMode::Mask ? R"("MASK")" : R"("BLEND")");
        if (m_.alpha_mode == AlphaMode::Mask) members.add_number("alphaCutoff", m_.alpha_cutoff, 0.5f);
        if (m_.is_emitter() ? m_.two_sided_emission : m_.double_sided) members.add("doubleSided", "true");
        add_extensions();
        if (!extensions_.is_empty()) members.add("extensions", extensions_.text());
        return members.text();
    }

private:
    static JsonMembers scale(float value) { return JsonMembers().add_number("scale", value, 1); }
    static void add_texture(JsonMembers& members, const char* name, const std::string& info) {
        if (!info.empty()) members.add(name, info);
    }
    void add_channel(JsonMembers& members, const char* name, const TextureRef& texture, uint8_t channel) {
        add_texture(members, name, textures_.channel(texture, channel, owner_));
    }
    void add_color(JsonMembers& members, const char* name, Rgb color) {
        if (!(color == Rgb{1, 1, 1})) members.add(name, json_of(color));
    }
    void extend(const char* name, const JsonMembers& members) {
        parts_.use(name);
        extensions_.add(name, members.text());
    }
    void lose(const char* what) { sink_.leave_out(fmt::format("{}: {}", owner_, what)); }

    bool is_glossy() const { return m_.kind == MaterialKind::MetallicRoughness; }

    void name_losses() {
        if (m_.kind == MaterialKind::Conductor)
            lose("glTF has no complex index of refraction; the metal has its colour at normal incidence");
        if (m_.has_rough_diffuse()) lose("the roughness of its diffuse light is lost");
        if (m_.has_microfacets() && m_.microfacet_distribution != MicrofacetDistribution::Ggx)
            lose("its microfacets become those of GGX");
        if (m_.has_microfacets() && m_.energy != MicrofacetEnergy::Compensated)
            lose("light that its rough reflection loses is returned");
        if (is_glossy() && m_.metallic > 0 && m_.metal_fresnel != MetalFresnel::Schlick)
            lose("the tint of the metal's edge is lost");
        if (m_.has_fuzz() && m_.fuzz_model != FuzzModel::Charlie) lose("its fuzz becomes glTF's sheen");
        if (m_.has_fuzz() && m_.fuzz_weight != 1) lose("the weight of its fuzz is lost");
        if (m_.has_coat() &&
            (m_.coat_ior != 1.5f || !(m_.coat_color == Rgb{1, 1, 1}) || m_.coat_color_texture.has_image()))
            lose("the index and the colour of its coat are lost");
        if (m_.has_coat_anisotropy()) lose("the anisotropy of its coat is lost");
        if (m_.is_emitter() && m_.two_sided_emission != m_.double_sided)
            lose("its faces hide and emit alike in glTF; both follow the emission");
        if (m_.medium.is_there()) lose("the medium within is lost");
        if (m_.is_clear_boundary) lose("its clear boundary becomes an invisible surface");
        if (m_.priority != 0) lose("its priority among solids is lost");
        if (m_.has_relative_ior && m_.ior < 1) lose("glTF has no index of refraction below 1; the bubble gets 1");
    }

    /// A measured metal's reflectance at normal incidence.
    Rgb base_color() const {
        if (m_.kind != MaterialKind::Conductor) return m_.base_color;
        const auto reflectance = [](float eta, float k) {
            return ((eta - 1) * (eta - 1) + k * k) / ((eta + 1) * (eta + 1) + k * k);
        };
        return {reflectance(m_.eta.r, m_.k.r), reflectance(m_.eta.g, m_.k.g), reflectance(m_.eta.b, m_.k.b)};
    }

    std::string metallic_roughness() {
        JsonMembers members;
        const Rgb color = base_color();
        if (!(color == Rgb{1, 1, 1}) || m_.alpha != 1)
            members.add("baseColorFactor", json_floats(std::array{color.r, color.g, color.b, m_.alpha}));
        const TextureRef &base = m_.base_color_texture, &alpha = m_.alpha_texture;
        if (alpha.has_image()) { // OBJ's; glTF has it in the colour's texture
            const TextureRef* const of_color = base.has_image() ? &base : nullptr;
            add_texture(
                members, "baseColorTexture",
                textures_.info({{{of_color, 0}, {of_color, 1}, {of_color, 2}, {&alpha, alpha.channel}}}, true, owner_));
        } else {
            add_texture(members, "baseColorTexture", textures_.info(base, true, owner_));
        }
        const bool is_metal = m_.kind == MaterialKind::Conductor;
        members.add_number("metallicFactor", is_metal ? 1.0f : is_glossy() ? m_.metallic : 0.0f, 1);
        members.add_number("roughnessFactor", m_.roughness, 1);
        const TextureRef &rough = m_.roughness_texture, &metal = m_.metallic_texture;
        const bool is_one = rough.image == metal.image && rough.channel == 1 && metal.channel == 2;
        add_texture(members, "metallicRoughnessTexture",
                    is_one
                        ? textures_.info(rough, false, owner_)
                        : textures_.info({{{}, {&rough, rough.channel}, {&metal, metal.channel}, {}}}, false, owner_));
        return members.text();
    }

    void add_emission(JsonMembers& members) {
        if (!m_.is_emissive()) return;
        const float strength = strength_of(m_.emission);
        members.add("emissiveFactor", json_of((1 / strength) * m_.emission));
        add_texture(members, "emissiveTexture", textures_.info(m_.emission_texture, true, owner_));
        if (strength != 1)
            extend("KHR_materials_emissive_strength", JsonMembers().add_number("emissiveStrength", strength, 1));
    }

    void add_extensions() {
        if (m_.is_unlit()) return extend("KHR_materials_unlit", {});
        if (m_.kind == MaterialKind::Diffuse) {
            extend("KHR_materials_specular", JsonMembers().add("specularFactor", "0"));
        } else if (m_.kind != MaterialKind::Conductor) {
            const float ior = max(m_.ior, 1.0f);
            if (ior != 1.5f) extend("KHR_materials_ior", JsonMembers().add_number("ior", ior, 1.5f));
            add_transmission();
        }
        if (is_glossy()) add_reflection();
        add_coat();
        add_fuzz();
        if (m_.has_thin_film()) add_thin_film();
        if (m_.has_anisotropy()) add_anisotropy();
    }

    void add_transmission() {
        JsonMembers members;
        if (m_.kind == MaterialKind::Dielectric) {
            members.add("transmissionFactor", "1");
        } else if (m_.transmits()) {
            members.add_number("transmissionFactor", m_.transmission_weight, 0);
            add_channel(members, "transmissionTexture", m_.transmission_texture, 0);
        }
        if (!members.is_empty()) extend("KHR_materials_transmission", members);
        if (m_.is_solid()) {
            JsonMembers volume;
            volume.add("thicknessFactor", "1"); // any number above 0
            if (m_.transmission_depth > 0) {
                volume.add_number("attenuationDistance", m_.transmission_depth, 0);
                add_color(volume, "attenuationColor", m_.transmission_color);
            }
            extend("KHR_materials_volume", volume);
        }
        if (!(m_.dispersion() > 0)) return;
        const float dispersion = 20 / m_.transmission_dispersion_abbe_number * m_.transmission_dispersion_scale;
        extend("KHR_materials_dispersion", JsonMembers().add_number("dispersion", dispersion, 0));
    }

    void add_reflection() {
        if (m_.has_own_reflection()) {
            JsonMembers members;
            members.add_number("specularFactor", m_.specular_weight, 1);
            add_color(members, "specularColorFactor", m_.specular_color);
            add_channel(members, "specularTexture", m_.specular_texture, 3);
            add_texture(members, "specularColorTexture", textures_.info(m_.specular_color_texture, true, owner_));
            extend("KHR_materials_specular", members);
        }
        if (m_.has_diffuse_transmission()) {
            JsonMembers members;
            members.add_number("diffuseTransmissionFactor", m_.diffuse_transmission_weight, 0);
            add_color(members, "diffuseTransmissionColorFactor", m_.diffuse_transmission_color);
            add_channel(members, "diffuseTransmissionTexture", m_.diffuse_transmission_texture, 3);
            add_texture(members, "diffuseTransmissionColorTexture",
                        textures_.info(m_.diffuse_transmission_color_texture, true, owner_));
            extend("KHR_materials_diffuse_transmission", members);
        }
        if (m_.has_retroreflection()) {
            JsonMembers members;
            members.add_number("retroreflectionFactor", m_.specular_retroreflectivity, 0);
            add_channel(members, "retroreflectionTexture", m_.retroreflectivity_texture, 0);
            extend("KHR_materials_retroreflection", members);
        }
    }

    void add_coat() {
        if (!m_.has_coat()) return;
        JsonMembers members;
        members.add_number("clearcoatFactor", m_.coat_weight, 0);
        members.add_number("clearcoatRoughnessFactor", m_.coat_roughness, 0);
        add_channel(members, "clearcoatTexture", m_.coat_texture, 0);
        add_channel(members, "clearcoatRoughnessTexture", m_.coat_roughness_texture, 1);
        add_texture(members, "clearcoatNormalTexture",
                    textures_.info(m_.coat_normal_texture, false, owner_, scale(m_.coat_normal_scale)));
        extend("KHR_materials_clearcoat", members);
    }

    void add_fuzz() {
        if (!m_.has_fuzz()) return;
        JsonMembers members;
        members.add("sheenColorFactor", json_of(m_.fuzz_color));
        members.add_number("sheenRoughnessFactor", m_.fuzz_roughness, 0);
        add_texture(members, "sheenColorTexture", textures_.info(m_.fuzz_color_texture, true, owner_));
        add_channel(members, "sheenRoughnessTexture", m_.fuzz_roughness_texture, 3);
        extend("KHR_materials_sheen", members);
    }

    void add_thin_film() {
        JsonMembers members;
        members.add_number("iridescenceFactor", m_.thin_film_weight, 0);
        members.add_number("iridescenceIor", m_.thin_film_ior, 1.3f);
        members.add_number("iridescenceThicknessMinimum", m_.thin_film_least_nm, 100);
        members.add_number("iridescenceThicknessMaximum", m_.thin_film_thickness_nm, 400);
        add_channel(members, "iridescenceTexture", m_.thin_film_texture, 0);
        add_channel(members, "iridescenceThicknessTexture", m_.thin_film_thickness_texture, 1);
        extend("KHR_materials_iridescence", members);
    }

    void add_anisotropy() {
        JsonMembers members;
        members.add_number("anisotropyStrength", m_.specular_roughness_anisotropy, 0);
        members.add_number("anisotropyRotation", m_.anisotropy_rotation, 0);
        add_texture(members, "anisotropyTexture", textures_.info(m_.anisotropy_texture, false, owner_));
        extend("KHR_materials_anisotropy", members);
    }

    const Material& m_;
    const std::string& owner_;
    TextureWriter& textures_;
    GlbParts& parts_;
    Sink& sink_;
    JsonMembers extensions_;
};

} // namespace

float strength_of(Rgb color) {
    float strength = 1;
    while (strength < max_component(color) && strength < 0x1p127f) strength *= 2;
    return strength;
}

std::string material_object(const Material& material, const std::string& owner, TextureWriter& textures,
                            GlbParts& parts, Sink& sink) {
    return Writer(material, owner, textures, parts, sink).text();
}

} // namespace pertev::glb
