#include "formats/gltf/specular_glossiness.h"

#include <array>
#include <map>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "base/parallel_for.h"
#include "image/srgb.h"

namespace pertev::gltf {
namespace {

constexpr float kDielectric = 0.04f;    // reflectance of what is no metal, for the conversion
constexpr float kMaxDielectric = 0.16f; // reflectance of an index of refraction of 2.33
constexpr float kGrey = 0.02f;          // channels that differ by no more count as equal

float brightness(Rgb c) { return sqrt(0.299f * c.r * c.r + 0.587f * c.g * c.g + 0.114f * c.b * c.b); }

float min_component(Rgb c) { return min(c.r, min(c.g, c.b)); }

/// Returns the metallic value that preserves both brightnesses.
float solve_metallic(float diffuse, float specular, float one_minus_specular) {
    if (specular < kDielectric) return 0;
    const float b = diffuse * one_minus_specular / (1 - kDielectric) + specular - 2 * kDielectric;
    const float c = kDielectric - specular;
    const float root = sqrt(max(b * b - 4 * kDielectric * c, 0.0f));
    return clamp((root - b) / (2 * kDielectric), 0.0f, 1.0f);
}

/// Returns base colour and metallic value by the published conversion, for an index of refraction of 1.5.
std::pair<Rgb, float> convert(Rgb diffuse, Rgb specular) {
    constexpr float least = 1e-6f;
    const float one_minus_specular = 1 - max_component(specular);
    const float metallic = solve_metallic(brightness(diffuse), brightness(specular), one_minus_specular);
    const Rgb of_diffuse = one_minus_specular / ((1 - kDielectric) * max(1 - metallic, least)) * diffuse;
    const float taken = kDielectric * (1 - metallic), scale = 1 / max(metallic, least);
    const Rgb of_specular = {scale * (specular.r - taken), scale * (specular.g - taken), scale * (specular.b - taken)};
    const float share = metallic * metallic;
    const auto mix = [&](float a, float b) { return clamp((1 - share) * a + share * b, 0.0f, 1.0f); };
    return {{mix(of_diffuse.r, of_specular.r), mix(of_diffuse.g, of_specular.g), mix(of_diffuse.b, of_specular.b)},
            metallic};
}

Rgb within_0_and_1(Rgb c) { return {clamp(c.r, 0.0f, 1.0f), clamp(c.g, 0.0f, 1.0f), clamp(c.b, 0.0f, 1.0f)}; }

struct Texel {
    Rgb color = {1, 1, 1}; // linear
    float alpha = 1;
};

/// The texels of a picture by position in [0, 1); white if there is no picture.
class Texels {
public:
    Texels(const Scene& scene, const TextureRef& ref)
        : image_(ref.has_image() ? &scene.images[static_cast<std::size_t>(ref.image)] : nullptr),
          is_srgb_(ref.is_srgb) {
        for (std::size_t i = 0; i < decoded_.size(); ++i) decoded_[i] = srgb_decode(static_cast<float>(i) / 255);
    }
    uint32_t width() const { return image_ == nullptr ? 1 : max(image_->rgba8.width, image_->rgba_float.width); }
    uint32_t height() const { return image_ == nullptr ? 1 : max(image_->rgba8.height, image_->rgba_float.height); }

    /// Returns the texel at the position that (x, y) has in a picture of `columns` by `rows`.
    Texel at(uint64_t x, uint64_t y, uint64_t columns, uint64_t rows) const {
        if (image_ == nullptr) return {};
        const std::size_t offset = (y * height() / rows * width() + x * width() / columns) * 4;
        if (!image_->rgba8.pixels.empty()) {
            const uint8_t* p = image_->rgba8.pixels.data() + offset;
            return {{decoded_[p[0]], decoded_[p[1]], decoded_[p[2]]}, static_cast<float>(p[3]) / 255};
        }
        const float* p = image_->rgba_float.pixels.data() + offset;
        const Rgb stored = {p[0], p[1], p[2]};
        return {within_0_and_1(is_srgb_ ? stored : srgb_decode(stored)), clamp(p[3], 0.0f, 1.0f)};
    }

private:
    const TextureImage* image_;
    bool is_srgb_; // then pictures in float are linear already
    std::array<float, 256> decoded_{};
};

struct ConvertedImages {
    TextureImage base_color, metallic_roughness;
};

ConvertedImages convert_images(const Scene& scene, const Material& material, const SpecularGlossiness& factors) {
    const Texels diffuse(scene, material.base_color_texture), specular(scene, material.roughness_texture);
    const uint32_t width = max(diffuse.width(), specular.width()), height = max(diffuse.height(), specular.height());
    ConvertedImages to;
    for (TextureImage* image : {&to.base_color, &to.metallic_roughness}) {
        image->rgba8 = {.width = width, .height = height, .pixels = std::vector<uint8_t>(size_t(4) * width * height)};
    }
    to.base_color.name = material.name + " (base colour of specular-glossiness)";
    to.metallic_roughness.name = material.name + " (metal and roughness of specular-glossiness)";
    parallel_for(height, 16, [&](uint64_t y) {
        for (uint64_t x = 0; x < width; ++x) {
            const Texel d = diffuse.at(x, y, width, height), s = specular.at(x, y, width, height);
            const auto [base, metallic] = convert(factors.diffuse * d.color, factors.specular * s.color);
            const std::size_t offset = (y * width + x) * 4;
            uint8_t* color = to.base_color.rgba8.pixels.data() + offset;
            uint8_t* surface = to.metallic_roughness.rgba8.pixels.data() + offset;
            color[0] = to_byte(srgb_encode(base.r));
            color[1] = to_byte(srgb_encode(base.g));
            color[2] = to_byte(srgb_encode(base.b));
            color[3] = to_byte(d.alpha);
            surface[1] = to_byte(1 - factors.glossiness * s.alpha);
            surface[2] = to_byte(metallic);
            surface[3] = 255;
        }
    });
    return to;
}

bool use_same_coordinates(const TextureRef& a, const TextureRef& b) {
    const auto members = [](const TextureRef& t) {
        return std::tuple(t.uv_set, t.wrap_s, t.wrap_t, t.m00, t.m01, t.m02, t.m10, t.m11, t.m12);
    };
    return members(a) == members(b);
}

} // namespace

MetallicRoughness metallic_roughness_of(const SpecularGlossiness& from, bool& is_exact) {
    MetallicRoughness to;
    const Rgb diffuse = within_0_and_1(from.diffuse), specular = within_0_and_1(from.specular);
    to.roughness = 1 - clamp(from.glossiness, 0.0f, 1.0f);
    const float reflectance = max_component(specular);
    is_exact = reflectance <= kMaxDielectric && reflectance - min_component(specular) <= kGrey;
    if (is_exact) {
        to.base_color = diffuse;
        to.ior = (1 + sqrt(reflectance)) / (1 - sqrt(reflectance));
        return to;
    }
    std::tie(to.base_color, to.metallic) = convert(diffuse, specular);
    return to;
}

void convert_textures(const std::vector<PendingConversion>& pending, uint64_t limit, Scene& scene, Sink& sink) {
    using Key = std::tuple<int32_t, int32_t, std::array<float, 7>>;
    std::map<Key, int32_t> known; // the first of the two images
    uint64_t bytes = 0;
    for (const auto& [index, factors, location] : pending) {
        Material& material = scene.materials[index];
        TextureRef& diffuse = material.base_color_texture;
        TextureRef& specular = material.roughness_texture;
        const TextureRef where = diffuse.has_image() ? diffuse : specular;
        const auto use_factors = [&](const char* why) {
            sink.leave_out({location, fmt::format("{}; the specular-glossiness texture is left out", why)});
            specular = material.metallic_texture = {};
        };
        if (!diffuse.has_image() && !specular.has_image()) continue; // the loader has reported why
        if (diffuse.has_image() && specular.has_image() && !use_same_coordinates(diffuse, specular)) {
            use_factors("the two textures use different texture coordinates");
            continue;
        }
        const Rgb d = factors.diffuse, s = factors.specular;
        const Key key = {diffuse.image, specular.image, {d.r, d.g, d.b, s.r, s.g, s.b, factors.glossiness}};
        auto found = known.find(key);
        if (found == known.end()) {
            const Texels a(scene, diffuse), b(scene, specular);
            bytes += uint64_t(8) * max(a.width(), b.width()) * max(a.height(), b.height());
            if (bytes > limit) {
                use_factors("the converted textures would take too much memory");
                continue;
            }
            ConvertedImages images = convert_images(scene, material, factors);
            found = known.emplace(key, static_cast<int32_t>(scene.images.size())).first;
            scene.images.push_back(std::move(images.base_color));
            scene.images.push_back(std::move(images.metallic_roughness));
        }
        material.base_color = {1, 1, 1};
        material.metallic = material.roughness = 1;
        material.ior = 1.5f;
        material.kind = MaterialKind::MetallicRoughness;
        diffuse = specular = where;
        diffuse.image = found->second;
        diffuse.is_srgb = true;
        specular.image = found->second + 1;
        specular.is_srgb = false;
        specular.channel = 1;
        material.metallic_texture = specular;
        material.metallic_texture.channel = 2;
    }
}

} // namespace pertev::gltf
