#include "formats/read_mtl.h"

#include <algorithm>
#include <istream>
#include <streambuf>

#include <fmt/format.h>
#include <tiny_obj_loader.h>

#include "base/read_file.h"
#include "math/vec3.h"

namespace fs = std::filesystem;

namespace pertev {
namespace {

/// tinyobjloader's -o, -s and -t take three numbers and swallow the file's name where there are fewer, which the format
/// allows: those left out are written in. Also gives every map_Bump one spelling.
std::string complete_options(const std::string& line) {
    std::string out;
    std::size_t at = 0;
    const auto word_at = [&](std::size_t& from) {
        from = std::min(line.find_first_not_of(" \t\r", from), line.size());
        return line.substr(from, std::min(line.find_first_of(" \t\r", from), line.size()) - from);
    };
    std::string key = word_at(at);
    if (!key.starts_with("map_") && key != "bump" && key != "norm" && key != "disp" && key != "refl") return line;
    at += key.size();
    if (key == "map_BUMP") key = "map_Bump";
    out = key;
    for (std::string word = word_at(at); word.starts_with('-'); word = word_at(at)) {
        at += word.size();
        out += " " + word;
        if (word != "-o" && word != "-s" && word != "-t") { // one value, or two for -mm
            for (int i = 0; i < (word == "-mm" ? 2 : 1); ++i) {
                const std::string value = word_at(at);
                at += value.size();
                out += " " + value;
            }
            continue;
        }
        for (int i = 0; i < 3; ++i) {
            std::size_t ahead = at;
            const std::string value = word_at(ahead);
            const bool is_number = !value.empty() && value.find_first_not_of("+-.0123456789eE") == value.npos;
            // A lone number may be the file's name, but then nothing comes after it.
            std::size_t after = ahead + value.size();
            if (is_number && !word_at(after).empty()) {
                at = ahead + value.size();
                out += " " + value;
            } else {
                out += word == "-s" ? " 1" : " 0";
            }
        }
    }
    return out + " " + line.substr(at);
}

/// An istream over a string that it does not copy.
class TextBuffer : public std::streambuf {
public:
    explicit TextBuffer(std::string& text) { setg(text.data(), text.data(), text.data() + text.size()); }
};

std::string complete_options_of_all(std::span<const std::byte> bytes) {
    const std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    std::string out;
    out.reserve(text.size() + 256);
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t end = std::min(text.find_first_of("\r\n", at), text.size());
        out += complete_options(text.substr(at, end - at));
        out += '\n';
        at = end + 1;
    }
    return out;
}

Rgb rgb(const float (&c)[3]) { return {c[0], c[1], c[2]}; }

/// GGX roughness (perceptual: alpha is its square) of a Phong exponent.
float roughness_of(float exponent) { return sqrt(sqrt(2.0f / (max(exponent, 0.0f) + 2.0f))); }

class Converter {
public:
    Converter(const fs::path& path, TextureLoader& loader, Messages& messages)
        : path_(path), loader_(loader), messages_(messages) {}

    MtlMaterial convert(const tinyobj::material_t& from) {
        MtlMaterial result;
        Material& to = result.material;
        to.name = from.name;
        to.base_color = rgb(from.diffuse);
        to.base_color_texture = texture(from.diffuse_texname, from.diffuse_texopt, true);
        if (to.base_color_texture.has_image() && is_black(to.base_color)) {
            to.base_color = grey(1); // 3ds Max writes Kd 0 0 0 beside a map; a map times nothing is not meant
        }
        to.emission = rgb(from.emission);
        to.emission_texture = texture(from.emissive_texname, from.emissive_texopt, true);
        if (to.emission_texture.has_image() && is_black(to.emission)) to.emission = grey(1);
        surface(from, to);
        alpha(from, result);
        bumps(from, result);
        left_out(from);
        return result;
    }

private:
    TextureRef texture(std::string name, const tinyobj::texture_option_t& option, bool is_colour) {
        TextureRef ref;
        while (!name.empty() && (name.back() == ' ' || name.back() == '\t')) name.pop_back();
        if (name.size() > 1 && name.front() == '"' && name.back() == '"') name = name.substr(1, name.size() - 2);
        if (name.empty()) return ref;
        ref.image = loader_.add_file(path_, name);
        ref.is_srgb = is_colour && option.colorspace != "linear";
        if (option.clamp) ref.wrap_s = ref.wrap_t = Wrap::ClampToEdge;
        // uv' = scale uv + offset with v upwards; ours points down: v_down = 1 - v_up, on both sides.
        ref.m00 = option.scale[0];
        ref.m02 = option.origin_offset[0];
        ref.m11 = option.scale[1];
        ref.m12 = 1 - option.scale[1] - option.origin_offset[1];
        return ref;
    }

    void surface(const tinyobj::material_t& from, Material& to) {
        const Rgb kd = rgb(from.diffuse), ks = rgb(from.specular), tf = rgb(from.transmittance);
        const float diffuse = to.base_color_texture.has_image() ? max(max_component(kd), 0.5f) : max_component(kd);
        const float specular = max_component(ks);
        const bool is_dark = diffuse <= 0.1f * max(specular, 0.2f);
        const bool is_ray_traced = from.illum == 3 || from.illum == 5 || from.illum == 8;
        const bool has_map_d = !from.alpha_texname.empty();

        if (from.roughness > 0 || from.metallic > 0 || !from.roughness_texname.empty() ||
            !from.metallic_texname.empty()) {
            to.kind = MaterialKind::MetallicRoughness;
            to.roughness_texture = texture(from.roughness_texname, from.roughness_texopt, false);
            to.metallic_texture = texture(from.metallic_texname, from.metallic_texopt, false);
            // A map without its number: 0 is what tinyobjloader has for "not there".
            to.roughness = to.roughness_texture.has_image() && from.roughness == 0 ? 1 : from.roughness;
            to.metallic = to.metallic_texture.has_image() && from.metallic == 0 ? 1 : from.metallic;
            if (from.ior > 1) to.ior = from.ior;
            return;
        }
        const bool is_glass = from.illum == 6 || from.illum == 7 ||
                              ((from.illum == 4 || from.illum == 9) && (from.dissolve < 1 || is_dark)) ||
                              (from.dissolve < 1 && from.ior > 1 && !is_black(tf));
        if (is_glass && !has_map_d) {
            to.kind = MaterialKind::Dielectric;
            to.roughness = 0;
            to.ior = from.ior > 1 ? from.ior : 1.5f;
            to.base_color_texture = {};
            to.base_color = is_black(tf) ? grey(1) : Rgb{safe_sqrt(tf.r), safe_sqrt(tf.g), safe_sqrt(tf.b)};
            return;
        }
        if ((specular > 0.1f && is_dark) || (is_ray_traced && specular > max(0.1f, diffuse))) {
            to.kind = MaterialKind::MetallicRoughness;
            to.metallic = 1;
            to.roughness = is_ray_traced ? 0.0f : roughness_of(from.shininess);
            to.base_color = ks;
            to.base_color_texture = {};
            return;
        }
        if (specular > 0.02f && !(ks == grey(0.5f)) && from.shininess > 1 && from.illum != 1) {
            const float f0 = min(specular / max(1.0f, specular + diffuse), 0.64f);
            to.kind = MaterialKind::MetallicRoughness;
            to.metallic = 0;
            to.roughness = roughness_of(from.shininess);
            to.ior = (1 + sqrt(f0)) / (1 - sqrt(f0));
        }
    }

    void alpha(const tinyobj::material_t& from, MtlMaterial& to) {
        if (to.material.kind == MaterialKind::Dielectric) return;
        to.material.alpha = clamp(from.dissolve, 0.0f, 1.0f);
        if (to.material.alpha < 1) to.material.alpha_mode = AlphaMode::Blend;
        to.material.alpha_texture = texture(from.alpha_texname, from.alpha_texopt, false);
        to.has_alpha_map = to.material.alpha_texture.has_image();
        to.alpha_channel = from.alpha_texopt.imfchan;
    }

    void bumps(const tinyobj::material_t& from, MtlMaterial& to) {
        to.material.normal_texture = texture(from.normal_texname, from.normal_texopt, false);
        to.material.normal_scale = from.normal_texopt.bump_multiplier;
        if (from.normal_texname.empty() && !from.bump_texname.empty()) {
            to.material.normal_texture = texture(from.bump_texname, from.bump_texopt, false);
            to.material.normal_scale = 1; // -bm is a height
            to.normal_may_be_height = to.material.normal_texture.has_image();
        }
    }

    void left_out(const tinyobj::material_t& from) {
        for (const auto& [key, name] :
             {std::pair("map_Ks", &from.specular_texname), std::pair("map_Ns", &from.specular_highlight_texname),
              std::pair("disp", &from.displacement_texname), std::pair("refl", &from.reflection_texname),
              std::pair("map_Ps", &from.sheen_texname)}) {
            if (!name->empty()) messages_.warn(fmt::format("{}: {} is left out", path_.string(), key));
        }
    }

    const fs::path& path_;
    TextureLoader& loader_;
    Messages& messages_;
};

std::size_t pixel_count(const TextureImage& image) {
    return max(image.rgba8.pixels.size(), image.rgba_float.pixels.size()) / 4;
}

/// In [0, 1]; of 8-bit images as stored.
float value(const TextureImage& image, std::size_t pixel, int channel) {
    const std::size_t at = 4 * pixel + static_cast<std::size_t>(channel);
    return image.rgba8.pixels.empty() ? image.rgba_float.pixels[at] : static_cast<float>(image.rgba8.pixels[at]) / 255;
}

/// A tangent-space normal map is bluish, and its texels are unit vectors; a height map is grey.
bool looks_like_normals(const TextureImage& image) {
    std::size_t good = 0, seen = 0;
    for (std::size_t i = 0; i < pixel_count(image); i += 7, ++seen) {
        const float r = value(image, i, 0), b = value(image, i, 2);
        const float square = length_squared(Vec3{2 * r - 1, 2 * value(image, i, 1) - 1, 2 * b - 1});
        good += b > 0.5f && b > r + 0.03f && square > 0.7f && square < 1.3f;
    }
    return seen > 0 && good > seen * 3 / 4;
}

struct AlphaStatistics {
    bool varies = false;    // some alpha below 1
    bool is_binary = false; // nearly all texels clear or solid: an outline, softened at most at its edge
};

AlphaStatistics look_at_channel(const TextureImage& image, int channel) {
    std::size_t between = 0, below = 0;
    for (std::size_t i = 0; i < pixel_count(image); ++i) {
        const float alpha = value(image, i, channel);
        between += alpha >= 0.125f && alpha < 0.875f;
        below += alpha < 1;
    }
    return {below > 0, between * 3 < pixel_count(image)};
}

} // namespace

std::map<std::string, MtlMaterial> read_mtl(const fs::path& path, TextureLoader& loader, Messages& messages) {
    std::string text = complete_options_of_all(read_file(path));
    TextBuffer buffer(text);
    std::istream stream(&buffer);
    std::map<std::string, int> by_name;
    std::vector<tinyobj::material_t> parsed;
    std::string warnings, errors;
    tinyobj::LoadMtl(&by_name, &parsed, &stream, &warnings, &errors);

    std::map<std::string, MtlMaterial> materials;
    Converter converter(path, loader, messages);
    for (const tinyobj::material_t& material : parsed) {
        if (material.name.empty() || materials.contains(material.name)) continue;
        materials.emplace(material.name, converter.convert(material));
    }
    if (materials.empty()) messages.warn(fmt::format("{}: no material (newmtl) in it", path.string()));
    return materials;
}

void finish_mtl_material(MtlMaterial& material, const std::vector<TextureImage>& images, const std::string& file,
                         Messages& messages) {
    Material& to = material.material;
    if (material.normal_may_be_height && to.normal_texture.has_image()) {
        if (!looks_like_normals(images[static_cast<std::size_t>(to.normal_texture.image)])) {
            messages.warn(fmt::format("{}: a map_bump that is a height map is left out; normal maps are read", file));
            to.normal_texture = {};
        }
    }
    if (!material.has_alpha_map || !to.alpha_texture.has_image()) return;
    const TextureImage& image = images[static_cast<std::size_t>(to.alpha_texture.image)];
    // `m` (matte) is the alpha channel; a grey picture without one is meant by its brightness.
    int channel = material.alpha_channel == 'g' ? 1 : (material.alpha_channel == 'b' ? 2 : 0);
    if (material.alpha_channel == 'm' && look_at_channel(image, 3).varies) channel = 3;
    to.alpha_texture.channel = static_cast<uint8_t>(channel);
    const AlphaStatistics statistics = look_at_channel(image, channel);
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
