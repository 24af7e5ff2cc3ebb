#include "formats/gltf/materials.h"

#include <limits>

#include <fmt/format.h>

namespace pertev::gltf {
namespace {

// The default material of glTF. Properties that a file's material lacks have its values.
Material make_default_material() {
    Material material;
    material.kind = MaterialKind::MetallicRoughness;
    material.base_color = {1, 1, 1};
    material.metallic = 1;
    material.roughness = 1;
    material.double_sided = false;
    return material;
}

} // namespace

uint32_t Materials::material_of(const JsonValue& primitive) {
    const std::optional<JsonValue> reference = material_in_variant(primitive);
    if (reference && textures_ != nullptr) {
        const uint32_t index = document_.index_into("materials", *reference);
        if (!by_index_[index]) {
            const std::size_t pending = pending_.size();
            by_index_[index] = add(read(document_.table("materials")[index]));
            if (pending_.size() > pending) pending_.back().material = *by_index_[index];
        }
        return *by_index_[index];
    }
    return default_material();
}

uint32_t Materials::default_material() {
    if (!default_) {
        default_ = add(textures_ == nullptr ? Material() : make_default_material());
    }
    return *default_;
}

uint32_t Materials::add(Material material) {
    scene_.materials.push_back(std::move(material));
    return static_cast<uint32_t>(scene_.materials.size() - 1);
}

Material Materials::read(const JsonValue& source) {
    Material material = make_default_material();
    material.origin = source.pointer();
    const auto attempt = [&](const auto& part) { attempt_at(source, part); };
    attempt([&] { material.name = source.string_or("name", ""); });
    attempt([&] {
        if (const auto pbr = source.find("pbrMetallicRoughness")) read_metallic_roughness(*pbr, material);
    });
    read_alpha(source, material);
    attempt([&] { read_ior(source, material); });
    attempt([&] { read_transmission(source, material); });
    attempt([&] { read_dispersion(source, material); });
    attempt([&] { read_anisotropy(source, material); });
    attempt([&] { read_retroreflection(source, material); });
    attempt([&] { read_thin_film(source, material); });
    attempt([&] { read_diffuse_transmission(source, material); });
    attempt([&] { read_scatter(source, material); });
    attempt([&] { read_specular(source, material); });
    attempt([&] { read_coat(source, material); });
    attempt([&] { read_fuzz(source, material); });
    attempt([&] { read_specular_glossiness(source, material); });
    attempt([&] {
        if (source.extension("KHR_materials_unlit")) material.kind = MaterialKind::Unlit;
    });
    attempt([&] { read_emission(source, material); });
    attempt([&] { material.double_sided = material.two_sided_emission = source.bool_or("doubleSided", false); });
    attempt([&] { material.normal_texture = read_texture(source, "normalTexture", false); });
    attempt([&] {
        if (const std::optional<JsonValue> normal = source.find("normalTexture")) {
            material.normal_scale = normal->float_or("scale", 1);
        }
    });
    return material;
}

void Materials::read_emission(const JsonValue& source, Material& material) {
    attempt_at(source, [&] {
        const std::array<float, 3> emission = source.floats_or<3>("emissiveFactor", {0, 0, 0});
        material.emission = Rgb{emission[0], emission[1], emission[2]};
    });
    material.emission_texture = read_texture(source, "emissiveTexture", true);
    const std::optional<JsonValue> extension = source.extension("KHR_materials_emissive_strength");
    if (!extension) return;
    const float strength = extension->float_or("emissiveStrength", 1);
    if (strength < 0) throw extension->at("emissiveStrength").error("expected a number of at least 0");
    const Rgb e = strength * material.emission;
    constexpr float largest = std::numeric_limits<float>::max();
    material.emission = Rgb{min(e.r, largest), min(e.g, largest), min(e.b, largest)};
}

void Materials::read_specular_glossiness(const JsonValue& source, Material& material) {
    const std::optional<JsonValue> extension = source.extension("KHR_materials_pbrSpecularGlossiness");
    if (!extension) return;
    std::array<float, 4> diffuse = {1, 1, 1, 1};
    std::array<float, 3> specular = {1, 1, 1};
    float glossiness = 1;
    attempt_at(*extension, [&] { diffuse = extension->floats_or<4>("diffuseFactor", diffuse); });
    attempt_at(*extension, [&] { specular = extension->floats_or<3>("specularFactor", specular); });
    attempt_at(*extension, [&] { glossiness = extension->float_or("glossinessFactor", glossiness); });
    const SpecularGlossiness factors = {
        {diffuse[0], diffuse[1], diffuse[2]}, {specular[0], specular[1], specular[2]}, clamp(glossiness, 0.0f, 1.0f)};
    material.alpha = diffuse[3];
    material.metallic_texture = material.roughness_texture = {};
    material.base_color_texture = read_texture(*extension, "diffuseTexture", true);
    const TextureRef both = read_texture(*extension, "specularGlossinessTexture", true);
    set_specular_glossiness(factors, both.has_image(), material);
    if (!both.has_image() || material.kind == MaterialKind::Diffuse) return;
    material.specular_color_texture = material.roughness_texture = both;
    pending_.push_back({.material = 0, .glossiness = factors.glossiness, .location = extension->location()});
}

void Materials::convert_textures(uint64_t limit) { convert_gloss(pending_, limit, scene_, sink_); }

void Materials::read_metallic_roughness(const JsonValue& pbr, Material& material) {
    attempt_at(pbr, [&] {
        const std::array<float, 4> color = pbr.floats_or<4>("baseColorFactor", {1, 1, 1, 1});
        material.base_color = {color[0], color[1], color[2]};
        material.alpha = color[3];
    });
    material.base_color_texture = read_texture(pbr, "baseColorTexture", true);
    attempt_at(pbr, [&] { material.metallic = pbr.float_or("metallicFactor", 1); });
    attempt_at(pbr, [&] { material.roughness = pbr.float_or("roughnessFactor", 1); });
    const TextureRef both = read_texture(pbr, "metallicRoughnessTexture", false);
    material.metallic_texture = material.roughness_texture = both;
    material.roughness_texture.channel = 1;
    material.metallic_texture.channel = 2;
}

void Materials::read_alpha(const JsonValue& source, Material& material) const {
    attempt_at(source, [&] {
        const std::string mode = source.string_or("alphaMode", "OPAQUE");
        if (mode == "MASK")
            material.alpha_mode = AlphaMode::Mask;
        else if (mode == "BLEND")
            material.alpha_mode = AlphaMode::Blend;
        else if (mode != "OPAQUE") {
            throw source.at("alphaMode").error(fmt::format("\"{}\"; expected OPAQUE, MASK or BLEND", mode));
        }
    });
    attempt_at(source, [&] { material.alpha_cutoff = source.float_or("alphaCutoff", 0.5f); });
}

void Materials::read_ior(const JsonValue& source, Material& material) const {
    const std::optional<JsonValue> extension = source.extension("KHR_materials_ior");
    if (!extension) return;
    const float ior = extension->float_or("ior", material.ior);
    if (ior == 0 || ior >= kLeastIor) {
        set_gltf_ior(material, ior);
    } else {
        sink_.warn({extension->location(), fmt::format("ior {} is not supported; expected 0 or at least {}, {} is used",
                                                       ior, kLeastIor, material.ior)});
    }
}

TextureRef Materials::read_texture(const JsonValue& parent, std::string_view key, bool is_srgb) {
    const std::optional<JsonValue> info = parent.find(key);
    TextureRef texture;
    if (!info) return texture;
    read_or_leave_out(*info, sink_, [&] { texture = textures_->read(*info); });
    texture.is_srgb = is_srgb;
    return texture;
}

} // namespace pertev::gltf
