#include "formats/gltf/material_pointers.h"

#include <algorithm>

#include "formats/files/parse_number.h"
#include "formats/gltf/textures.h"

namespace pertev::gltf {
namespace {

constexpr std::string_view kMaterials = "/materials/";
constexpr std::string_view kDispersion = "/extensions/KHR_materials_dispersion/dispersion";
constexpr std::string_view kEmission = "/emissiveFactor",
                           kStrength = "/extensions/KHR_materials_emissive_strength/emissiveStrength";

// KHR_materials_pbrSpecularGlossiness replaces these.
constexpr std::string_view kOfMetal[] = {"/pbrMetallicRoughness/", "/extensions/KHR_materials_ior/",
                                         "/extensions/KHR_materials_specular/"};

struct NamedNumber {
    std::string_view path; // beneath the material
    const char *name, *further = nullptr;
};
constexpr NamedNumber kNumbers[] = {
    {"/pbrMetallicRoughness/baseColorFactor", "base_color", "alpha"},
    {"/pbrMetallicRoughness/metallicFactor", "metallic"},
    {"/pbrMetallicRoughness/roughnessFactor", "roughness"},
    {"/alphaCutoff", "alpha_cutoff"},
    {kEmission, "emission"},
    {kStrength, "emission"},
    {"/normalTexture/scale", "normal_scale"},
    {"/extensions/KHR_materials_ior/ior", "ior"},
    {"/extensions/KHR_materials_transmission/transmissionFactor", "transmission_weight"},
    {"/extensions/KHR_materials_volume/attenuationDistance", "transmission_depth"},
    {"/extensions/KHR_materials_volume/attenuationColor", "transmission_color"},
    {kDispersion, "transmission_dispersion_scale"},
    {"/extensions/KHR_materials_clearcoat/clearcoatFactor", "coat_weight"},
    {"/extensions/KHR_materials_clearcoat/clearcoatRoughnessFactor", "coat_roughness"},
    {"/extensions/KHR_materials_clearcoat/clearcoatNormalTexture/scale", "coat_normal_scale"},
    {"/extensions/KHR_materials_sheen/sheenColorFactor", "fuzz_color"},
    {"/extensions/KHR_materials_sheen/sheenRoughnessFactor", "fuzz_roughness"},
    {"/extensions/KHR_materials_specular/specularFactor", "specular_weight"},
    {"/extensions/KHR_materials_specular/specularColorFactor", "specular_color"},
    {"/extensions/KHR_materials_anisotropy/anisotropyStrength", "specular_roughness_anisotropy"},
    {"/extensions/KHR_materials_anisotropy/anisotropyRotation", "anisotropy_rotation"},
    {"/extensions/KHR_materials_iridescence/iridescenceFactor", "thin_film_weight"},
    {"/extensions/KHR_materials_iridescence/iridescenceIor", "thin_film_ior"},
    {"/extensions/KHR_materials_iridescence/iridescenceThicknessMinimum", "thin_film_least_nm"},
    {"/extensions/KHR_materials_iridescence/iridescenceThicknessMaximum", "thin_film_thickness_nm"},
    {"/extensions/KHR_materials_retroreflection/retroreflectionFactor", "specular_retroreflectivity"},
    {"/extensions/KHR_materials_diffuse_transmission/diffuseTransmissionFactor", "diffuse_transmission_weight"},
    {"/extensions/KHR_materials_diffuse_transmission/diffuseTransmissionColorFactor", "diffuse_transmission_color"}};

struct NamedTexture {
    std::string_view path; // beneath the material
    const char *slot, *further = nullptr;
};
constexpr NamedTexture kTextures[] = {
    {"/pbrMetallicRoughness/baseColorTexture", "base_color_texture"},
    {"/pbrMetallicRoughness/metallicRoughnessTexture", "metallic_texture", "roughness_texture"},
    {"/normalTexture", "normal_texture"},
    {"/emissiveTexture", "emission_texture"},
    {"/extensions/KHR_materials_transmission/transmissionTexture", "transmission_texture"},
    {"/extensions/KHR_materials_clearcoat/clearcoatTexture", "coat_texture"},
    {"/extensions/KHR_materials_clearcoat/clearcoatRoughnessTexture", "coat_roughness_texture"},
    {"/extensions/KHR_materials_clearcoat/clearcoatNormalTexture", "coat_normal_texture"},
    {"/extensions/KHR_materials_sheen/sheenColorTexture", "fuzz_color_texture"},
    {"/extensions/KHR_materials_sheen/sheenRoughnessTexture", "fuzz_roughness_texture"},
    {"/extensions/KHR_materials_specular/specularTexture", "specular_texture"},
    {"/extensions/KHR_materials_specular/specularColorTexture", "specular_color_texture"},
    {"/extensions/KHR_materials_anisotropy/anisotropyTexture", "anisotropy_texture"},
    {"/extensions/KHR_materials_iridescence/iridescenceTexture", "thin_film_texture"},
    {"/extensions/KHR_materials_iridescence/iridescenceThicknessTexture", "thin_film_thickness_texture"},
    {"/extensions/KHR_materials_retroreflection/retroreflectionTexture", "retroreflectivity_texture"},
    {"/extensions/KHR_materials_diffuse_transmission/diffuseTransmissionTexture", "diffuse_transmission_texture"},
    {"/extensions/KHR_materials_diffuse_transmission/diffuseTransmissionColorTexture",
     "diffuse_transmission_color_texture"},
    {"/extensions/KHR_materials_pbrSpecularGlossiness/diffuseTexture", "base_color_texture"},
    {"/extensions/KHR_materials_pbrSpecularGlossiness/specularGlossinessTexture", "specular_color_texture",
     "roughness_texture"}};

struct PartOfTransform {
    std::string_view name;
    AnimatedPart part;
};
constexpr PartOfTransform kParts[] = {{"offset", AnimatedPart::TextureOffset},
                                      {"scale", AnimatedPart::TextureScale},
                                      {"rotation", AnimatedPart::TextureRotation}};
constexpr std::string_view kTransform = "/extensions/KHR_texture_transform/";

/// Returns the member at a path "/name/name" of names without special characters.
std::optional<JsonValue> member_at(const JsonValue& object, std::string_view path) {
    std::optional<JsonValue> found = object;
    while (found && !path.empty()) {
        const std::size_t end = std::min(path.find('/', 1), path.size());
        found = found->find(path.substr(1, end - 1));
        path.remove_prefix(end);
    }
    return found;
}

/// Returns the part of a texture's transform that a path below a material names; nothing for another path.
std::optional<MaterialPointer> find_texture(const JsonValue& material, std::string_view path) {
    const std::size_t end = path.rfind(kTransform);
    if (end == path.npos) return std::nullopt;
    const auto* const part = std::ranges::find(kParts, path.substr(end + kTransform.size()), &PartOfTransform::name);
    const auto* const texture = std::ranges::find(kTextures, path.substr(0, end), &NamedTexture::path);
    if (part == std::end(kParts) || texture == std::end(kTextures)) return std::nullopt;
    MaterialPointer found;
    found.part = part->part;
    uint8_t slot = 0;
    MaterialParameters any;
    visit_textures(any, [&](TextureRef&, std::string_view name) {
        if (name == texture->slot || (texture->further != nullptr && name == texture->further))
            found.numbers.push_back(slot);
        ++slot;
    });
    const std::string_view of_transform = path.substr(0, end + kTransform.size() - 1);
    if (const auto transform = member_at(material, of_transform))
        found.texture_at_rest = read_texture_transform(*transform);
    return found;
}

} // namespace

std::optional<MaterialPointer> find_material_pointer(const Document& document, std::string_view pointer) {
    if (!pointer.starts_with(kMaterials)) return std::nullopt;
    const std::string_view rest = pointer.substr(kMaterials.size());
    const std::size_t end = rest.find('/');
    if (end == rest.npos) return std::nullopt;
    const std::optional<uint32_t> index = parse_whole_number<uint32_t>(rest.substr(0, end));
    if (!index || *index >= document.table("materials").size()) return std::nullopt;
    const std::string_view path = rest.substr(end);
    const JsonValue& material = document.table("materials")[*index];
    if (material.extension("KHR_materials_pbrSpecularGlossiness") &&
        std::ranges::any_of(kOfMetal, [&](std::string_view start) { return path.starts_with(start); }))
        return std::nullopt;
    if (auto texture = find_texture(material, path)) {
        texture->material = *index;
        return texture;
    }
    for (const NamedNumber& number : kNumbers) {
        if (path != number.path) continue;
        MaterialPointer found = {.material = *index, .numbers = material_numbers(number.name)};
        if (number.further != nullptr) found.numbers.push_back(material_numbers(number.further).at(0));
        found.components = found.numbers.size();
        if (path == kEmission) {
            const auto extension = material.extension("KHR_materials_emissive_strength");
            if (extension) found.scale = extension->float_or("emissiveStrength", 1);
        } else if (path == kDispersion) { // Abbe's number is 1 (Materials)
            found.scale = 1 / kAbbeNumberOfDispersion;
        } else if (path == kStrength) {
            const std::array<float, 3> color = material.floats_or<3>("emissiveFactor", {0, 0, 0});
            found.components = 1;
            found.factor = {color[0], color[1], color[2]};
        }
        return found;
    }
    return std::nullopt;
}

} // namespace pertev::gltf
