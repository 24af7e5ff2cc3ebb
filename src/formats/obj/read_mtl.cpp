#include "formats/obj/read_mtl.h"

#include <fmt/format.h>

#include "base/error.h"
#include "base/read_file.h"
#include "formats/gltf/uri.h"
#include "formats/obj/parse_mtl.h"
#include "formats/obj/texel_values.h"
#include "math/vec3.h"

namespace fs = std::filesystem;

namespace pertev {
namespace {

/// GGX roughness (perceptual: alpha is its square) of a Phong exponent.
float roughness_of(float exponent) { return sqrt(sqrt(2.0f / (max(exponent, 0.0f) + 2.0f))); }

/// Returns the stated index if it is at least 1 (an index of 1 bends no light); else the index that Blender's importer
/// sets for glass.
float index_of(const MtlStatements& from) { return from.ni >= 1 ? from.ni : 1.5f; }

/// Least index of glass. One below 1 is a bubble's over that of what is around it; that of no pair of substances is
/// below a quarter, so it is no index.
constexpr float kLeastOfGlass = 0.25f;

float index_of_glass(const MtlStatements& from) { return from.ni >= kLeastOfGlass ? from.ni : index_of(from); }

/// Returns whether glass has its stated index, which bends light.
bool bends_light(const MtlStatements& from) { return from.ni >= kLeastOfGlass && from.ni != 1; }

class Converter {
public:
    Converter(const fs::path& path, TextureLoader& loader, Sink& sink) : path_(path), loader_(loader), sink_(sink) {}

    MtlMaterial convert(const MtlStatements& from) {
        MtlMaterial result;
        Material& to = result.material;
        to.name = from.name;
        to.origin = fmt::format("{}:{}", path_.string(), from.line);
        to.base_color = from.kd.value_or(to.base_color);
        to.base_color_texture = texture(from.map_kd, true);
        if (to.base_color_texture.has_image() && is_black(from.kd.value_or(Rgb{}))) {
            to.base_color = grey(1); // 3ds Max writes Kd 0 0 0 beside a map; a map times nothing is not meant
        }
        to.emission = from.ke;
        to.emission_texture = texture(from.map_ke, true);
        if (to.emission_texture.has_image() && is_black(to.emission)) to.emission = grey(1);
        surface(from, to);
        layers(from, to);
        alpha(from, result);
        bumps(from, result);
        return result;
    }

private:
    TextureRef texture(const MtlTexture& from, bool is_colour) {
        TextureRef ref;
        if (from.name.empty()) return ref;
        try {
            ref.image = loader_.add_file(FileLocation{path_.string(), from.line}, gltf::plain_file_name(from.name));
        } catch (const Error& error) { // the file is outside the allowed folders
            if (error.code() != ErrorCode::BadInput) throw;
            sink_.leave_out(error.remark().and_then("; only its factor is used"));
        }
        ref.is_srgb = is_colour && !from.is_linear;
        if (from.clamp) ref.wrap_s = ref.wrap_t = Wrap::ClampToEdge;
        // uv' = scale uv + offset with v upwards; ours points down: v_down = 1 - v_up, on both sides.
        ref.m00 = from.scale.x;
        ref.m02 = from.offset.x;
        ref.m11 = from.scale.y;
        ref.m12 = 1 - from.scale.y - from.offset.y;
        return ref;
    }

    void surface(const MtlStatements& from, Material& to) {
        const float kd = max_component(from.kd.value_or(Rgb{}));
        const float diffuse = to.base_color_texture.has_image() ? max(kd, 0.5f) : kd;
        const float specular = max_component(from.ks);
        const bool is_dark = diffuse <= 0.1f * max(specular, 0.2f);
        const bool is_ray_traced = from.illum == 3 || from.illum == 5 || from.illum == 8;
        const bool has_map_d = !from.map_d.name.empty();

        if (from.pr > 0 || from.pm > 0 || !from.map_pr.name.empty() || !from.map_pm.name.empty()) {
            to.kind = MaterialKind::MetallicRoughness;
            to.roughness_texture = texture(from.map_pr, false);
            to.metallic_texture = texture(from.map_pm, false);
            // A map without its number, or with 0, which exporters write unasked.
            to.roughness = to.roughness_texture.has_image() && from.pr == 0 ? 1 : from.pr;
            to.metallic = to.metallic_texture.has_image() && from.pm == 0 ? 1 : from.pm;
            to.ior = index_of(from);
            return;
        }
        const bool is_glass = from.illum == 6 || from.illum == 7 || ((from.illum == 4 || from.illum == 9) && is_dark) ||
                              (from.d < 1 && bends_light(from) && !is_black(from.tf));
        if (is_glass && !has_map_d) {
            to.kind = MaterialKind::Dielectric;
            to.roughness = 0;
            to.ior = index_of_glass(from);
            to.has_relative_ior = to.ior < 1;
            to.base_color_texture = {};
            const Rgb tf = from.tf;
            to.base_color = is_black(tf) ? grey(1) : Rgb{safe_sqrt(tf.r), safe_sqrt(tf.g), safe_sqrt(tf.b)};
            return;
        }
        if ((specular > 0.1f && is_dark) || (is_ray_traced && specular > max(0.1f, diffuse))) {
            to.kind = MaterialKind::MetallicRoughness;
            to.metallic = 1;
            to.roughness = is_ray_traced ? 0.0f : roughness_of(from.ns);
            to.base_color = from.ks;
            to.base_color_texture = {};
            return;
        }
        if (specular > 0.02f && !(from.ks == grey(0.5f)) && from.ns > 1 && from.illum != 1) {
            const float f0 = min(specular / max(1.0f, specular + diffuse), 0.64f);
            to.kind = MaterialKind::MetallicRoughness;
            to.metallic = 0;
            to.roughness = roughness_of(from.ns);
            to.ior = (1 + sqrt(f0)) / (1 - sqrt(f0));
        }
    }

    /// Reads the anisotropy, the coat and the sheen. A map without its number, or with 0, counts alone.
    void layers(const MtlStatements& from, Material& to) {
        const auto factor = [](float number, const TextureRef& map) {
            return map.has_image() && number == 0 ? 1 : number;
        };
        to.specular_roughness_anisotropy = from.aniso;
        to.anisotropy_rotation = 2 * kPi * from.anisor;
        to.coat_texture = texture(from.map_pc, false);
        to.coat_weight = factor(from.pc, to.coat_texture);
        if (to.coat_weight > 0) {
            to.coat_roughness_texture = texture(from.map_pcr, false);
            to.coat_roughness = factor(from.pcr, to.coat_roughness_texture);
        }
        to.fuzz_color_texture = texture(from.map_ps, false); // a grey map of the weight
        to.fuzz_weight = factor(from.ps, to.fuzz_color_texture);
    }

    void alpha(const MtlStatements& from, MtlMaterial& to) {
        if (to.material.kind == MaterialKind::Dielectric) return;
        to.material.alpha = clamp(from.d, 0.0f, 1.0f);
        if (to.material.alpha < 1) to.material.alpha_mode = AlphaMode::Blend;
        to.material.alpha_texture = texture(from.map_d, false);
        to.has_alpha_map = to.material.alpha_texture.has_image();
        to.alpha_channel = from.map_d.channel;
    }

    void bumps(const MtlStatements& from, MtlMaterial& to) {
        to.material.normal_texture = texture(from.norm, false);
        to.material.normal_scale = from.norm.bump_multiplier;
        if (from.bump.name.empty()) return;
        if (!from.norm.name.empty()) {
            sink_.leave_out(
                {FileLocation{path_.string(), from.bump.line}, "the bumps are left out beside a normal map"});
            return;
        }
        to.material.normal_texture = texture(from.bump, false);
        to.material.normal_scale = 1;
        to.normal_may_be_height = to.material.normal_texture.has_image();
        to.bump_multiplier = from.bump.bump_multiplier;
        to.bump_channel = from.bump.channel;
    }

    const fs::path& path_;
    TextureLoader& loader_;
    Sink& sink_;
};

struct AlphaStatistics {
    bool varies = false;    // some alpha below 1
    bool is_binary = false; // nearly all texels clear or solid: an outline, softened at most at its edge
};

AlphaStatistics alpha_statistics(const TextureImage& image, std::size_t channel) {
    std::size_t between = 0, below = 0;
    for (std::size_t i = 0; i < pixel_count(image); ++i) {
        const float alpha = texel_value(image, i, channel);
        between += alpha >= 0.125f && alpha < 0.875f;
        below += alpha < 1;
    }
    return {below > 0, between * 3 < pixel_count(image)};
}

} // namespace

std::map<std::string, MtlMaterial> read_mtl(const fs::path& path, TextureLoader& loader, Sink& sink) {
    return read_mtl(read_file(path), path, loader, sink);
}

std::map<std::string, MtlMaterial> read_mtl(std::span<const std::byte> bytes, const fs::path& path,
                                            TextureLoader& loader, Sink& sink) {
    std::map<std::string, MtlMaterial> materials;
    Converter converter(path, loader, sink);
    for (const MtlStatements& statements : parse_mtl(bytes, path.string(), sink)) {
        if (statements.name.empty() || materials.contains(statements.name)) continue;
        materials.emplace(statements.name, converter.convert(statements));
    }
    if (materials.empty()) sink.warn({FileLocation{path.string()}, "the file defines no material (newmtl)"});
    return materials;
}

void finish_mtl_material(MtlMaterial& material, const std::vector<TextureImage>& images) {
    Material& to = material.material;
    if (!material.has_alpha_map || !to.alpha_texture.has_image()) return;
    const TextureImage& image = images[static_cast<std::size_t>(to.alpha_texture.image)];
    // `m` (matte) is the alpha channel; a grey picture without one is meant by its brightness.
    std::size_t channel = material.alpha_channel == 'g' ? 1 : (material.alpha_channel == 'b' ? 2 : 0);
    if (material.alpha_channel == 'm' && alpha_statistics(image, 3).varies) channel = 3;
    to.alpha_texture.channel = static_cast<uint8_t>(channel);
    const AlphaStatistics statistics = alpha_statistics(image, channel);
    if (to.alpha_texture.image == to.base_color_texture.image) {
        // Its alpha counts by itself: the same again would be its square. Without one, an exporter wrote the name
        // twice.
        to.alpha_texture = {};
        if (channel != 3 && material.alpha_channel == 'm') return;
    }
    if (to.alpha < 1) return; // Blend already
    to.alpha_mode =
        !statistics.varies ? AlphaMode::Opaque : (statistics.is_binary ? AlphaMode::Mask : AlphaMode::Blend);
}

} // namespace pertev
