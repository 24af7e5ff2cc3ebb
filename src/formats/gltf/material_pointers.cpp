#include "formats/gltf/material_pointers.h"

#include <algorithm>

#include "formats/files/parse_number.h"

namespace pertev::gltf {
namespace {

constexpr std::string_view kMaterials = "/materials/";
constexpr std::string_view kDispersion = "/extensions/KHR_materials_dispersion/dispersion";
constexpr std::string_view kEmission = "/emissiveFactor",
                           kStrength = "/extensions/KHR_materials_emissive_strength/emissiveStrength";

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

} // namespace

std::optional<MaterialPointer> find_material_pointer(const Document& document, std::string_view pointer) {
    if (!pointer.starts_with(kMaterials)) return std::nullopt;
    const std::string_view rest = pointer.substr(kMaterials.size());
    const std::size_t end = rest.find('/');
    if (end == rest.npos) return std::nullopt;
    const std::optional<uint32_t> index = parse_whole_number<uint32_t>(rest.substr(0, end));
    if (!index || *index >= document.table("materials").size()) return std::nullopt;
    const std::string_view path = rest.substr(end);
    for (const NamedNumber& number : kNumbers) {
        if (path != number.path) continue;
        MaterialPointer found = {.material = *index, .numbers = material_numbers(number.name)};
        if (number.further != nullptr) found.numbers.push_back(material_numbers(number.further).at(0));
        found.components = found.numbers.size();
        const JsonValue& material = document.table("materials")[*index];
        if (path == kEmission) {
            const auto extension = material.extension("KHR_materials_emissive_strength");
            if (extension) found.scale = extension->float_or("emissiveStrength", 1);
        } else if (path == kDispersion) { // Abbe's number stays that of the material
            const auto extension = material.extension("KHR_materials_dispersion");
            if (extension) found.scale = 1.0f / std::max(extension->float_or("dispersion", 0), 1.0f);
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
