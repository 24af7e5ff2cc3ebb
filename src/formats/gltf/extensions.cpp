#include "formats/gltf/extensions.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "formats/gltf/light.h"

namespace pertev::gltf {
namespace {

constexpr std::array<std::string_view, 25> kRead = {"EXT_lights_ies",
                                                    "EXT_lights_image_based",
                                                    "EXT_mesh_gpu_instancing",
                                                    "EXT_meshopt_compression",
                                                    "KHR_animation_pointer",
                                                    "KHR_materials_anisotropy",
                                                    "KHR_materials_clearcoat",
                                                    "KHR_materials_diffuse_transmission",
                                                    "KHR_materials_dispersion",
                                                    "KHR_materials_emissive_strength",
                                                    "KHR_materials_ior",
                                                    "KHR_materials_iridescence",
                                                    "KHR_materials_pbrSpecularGlossiness",
                                                    "KHR_materials_retroreflection",
                                                    "KHR_materials_sheen",
                                                    "KHR_materials_specular",
                                                    "KHR_materials_transmission",
                                                    "KHR_materials_unlit",
                                                    "KHR_materials_variants",
                                                    "KHR_materials_volume",
                                                    "KHR_materials_volume_scatter",
                                                    "KHR_mesh_quantization",
                                                    "KHR_meshopt_compression",
                                                    "KHR_node_visibility",
                                                    "KHR_texture_transform"};

// These change only the metadata of pictures.
constexpr std::array<std::string_view, 2> kWithoutEffect = {"KHR_xmp", "KHR_xmp_json_ld"};

struct Conversion {
    std::string_view extension, command; // command of gltf-transform; empty: it has none
};

// Compressions, for which a file may also have uncompressed data: primitives and textures warn if they have no
// alternative.
constexpr std::array<Conversion, 5> kConversions = {{{"KHR_draco_mesh_compression", "copy"},
                                                     {"KHR_texture_basisu", "ktxdecompress"},
                                                     {"EXT_texture_webp", "png"},
                                                     {"EXT_texture_avif", "png"},
                                                     {"MSFT_texture_dds", ""}}};

template <class Names>
bool holds(const Names& names, std::string_view name) {
    return std::find(names.begin(), names.end(), name) != names.end();
}

const Conversion* conversion_of(std::string_view extension) {
    const auto found = std::ranges::find(kConversions, extension, &Conversion::extension);
    return found == kConversions.end() ? nullptr : &*found;
}

} // namespace

bool is_known_extension(std::string_view name) {
    return holds(kRead, name) || holds(light_extensions(), name) || holds(kWithoutEffect, name) ||
           conversion_of(name) != nullptr;
}

std::string conversion_advice(std::string_view extension, const std::filesystem::path& file) {
    const Conversion* conversion = conversion_of(extension);
    if (conversion == nullptr) return "";
    if (conversion->command.empty()) {
        return "; this command converts each of its pictures, for the texture's \"source\": magick NAME.dds NAME.png";
    }
    std::filesystem::path to = file.filename();
    to.replace_filename(to.stem().string() + "-converted" + to.extension().string());
    return fmt::format("; this command converts the file: npx @gltf-transform/cli {} \"{}\" \"{}\"",
                       conversion->command, file.filename().string(), to.string());
}

} // namespace pertev::gltf
