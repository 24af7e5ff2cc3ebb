#include "formats/obj/bump_normals.h"

#include <map>
#include <set>
#include <utility>

#include "base/parallel_for.h"
#include "formats/obj/texel_values.h"
#include "image/srgb.h"
#include "math/vec3.h"

namespace pertev {
namespace {

/// Returns whether an image is a tangent-space normal map, which is bluish and whose texels are unit vectors; a height
/// map is grey.
bool looks_like_normals(const TextureImage& image) {
    std::size_t good = 0, seen = 0;
    for (std::size_t i = 0; i < pixel_count(image); i += 7, ++seen) {
        const float r = texel_value(image, i, 0), b = texel_value(image, i, 2);
        const float square = length_squared(Vec3{2 * r - 1, 2 * texel_value(image, i, 1) - 1, 2 * b - 1});
        good += b > 0.5f && b > r + 0.03f && square > 0.7f && square < 1.3f;
    }
    return seen > 0 && good > seen * 3 / 4;
}

bool is_color_channel(char c) { return c == 'r' || c == 'g' || c == 'b'; }

/// The heights of an image by position, with its continuation beyond the edges.
class Heights {
public:
    Heights(const TextureImage& image, char channel, Wrap wrap)
        : image_(image), channel_(channel), wrap_(wrap), width_(max(image.rgba8.width, image.rgba_float.width)),
          height_(max(image.rgba8.height, image.rgba_float.height)) {}
    uint32_t width() const { return width_; }
    uint32_t height() const { return height_; }

    /// Returns the normal at a pixel, with x to the right and y up.
    Vec3 normal(int64_t x, int64_t y) const {
        const float scale = 0.5f * kBumpHeight * static_cast<float>(max(width_, height_));
        const float along_x = scale * (at(x + 1, y) - at(x - 1, y)), along_y = scale * (at(x, y - 1) - at(x, y + 1));
        const Vec3 normal = normalize(Vec3{-along_x, -along_y, 1});
        return is_finite(normal) ? normal : Vec3{0, 0, 1};
    }

private:
    static int64_t wrapped(int64_t i, int64_t size, Wrap wrap) {
        if (i >= 0 && i < size) return i;
        return wrap == Wrap::Repeat ? (i + size) % size : (i < 0 ? 0 : size - 1);
    }

    float at(int64_t x, int64_t y) const {
        const int64_t column = wrapped(x, width_, wrap_), row = wrapped(y, height_, wrap_);
        const auto pixel = static_cast<std::size_t>(row * int64_t(width_) + column);
        if (is_color_channel(channel_)) {
            return texel_value(image_, pixel, channel_ == 'r' ? 0 : (channel_ == 'g' ? 1 : 2));
        }
        const float r = texel_value(image_, pixel, 0), g = texel_value(image_, pixel, 1),
                    b = texel_value(image_, pixel, 2);
        return r == g && g == b ? r : luminance(Rgb{r, g, b});
    }

    const TextureImage& image_;
    char channel_;
    Wrap wrap_;
    uint32_t width_, height_;
};

/// Removes those of `candidates` that no texture uses, and renumbers the textures.
void remove_unused(const std::set<int32_t>& candidates, Scene& scene) {
    std::vector<bool> is_used(scene.images.size());
    for (const Material& material : scene.materials) {
        for (const TextureRef* ref : material.textures()) is_used[static_cast<std::size_t>(ref->image)] = true;
    }
    std::vector<TextureImage> kept;
    std::vector<int32_t> renumbered(scene.images.size(), kNoImage);
    for (std::size_t i = 0; i < scene.images.size(); ++i) {
        if (!is_used[i] && candidates.contains(static_cast<int32_t>(i))) continue;
        renumbered[i] = static_cast<int32_t>(kept.size());
        kept.push_back(std::move(scene.images[i]));
    }
    scene.images = std::move(kept);
    for (Material& material : scene.materials) {
        visit_textures(material, [&](TextureRef& ref, const char*) {
            if (ref.has_image()) ref.image = renumbered[static_cast<std::size_t>(ref.image)];
        });
    }
}

} // namespace

TextureImage normals_of_heights(const TextureImage& image, char channel, Wrap wrap) {
    const Heights heights(image, channel, wrap);
    TextureImage to;
    to.name = image.name;
    const bool is_float = image.rgba8.pixels.empty();
    const std::size_t count = 4 * pixel_count(image);
    if (is_float) {
        to.rgba_float = {heights.width(), heights.height(), 4, std::vector<float>(count)};
    } else {
        to.rgba8 = {heights.width(), heights.height(), std::vector<uint8_t>(count)};
    }
    parallel_for(heights.height(), 16, [&](uint64_t y) {
        std::size_t at = 4 * static_cast<std::size_t>(y) * heights.width();
        for (uint32_t x = 0; x < heights.width(); ++x, at += 4) {
            const Vec3 n = heights.normal(x, static_cast<int64_t>(y));
            const float texel[4] = {0.5f + 0.5f * n.x, 0.5f + 0.5f * n.y, 0.5f + 0.5f * n.z, 1};
            for (std::size_t c = 0; c < 4; ++c) {
                if (is_float) {
                    to.rgba_float.pixels[at + c] = texel[c];
                } else {
                    to.rgba8.pixels[at + c] = to_byte(texel[c]);
                }
            }
        }
    });
    return to;
}

std::vector<bool> convert_bumps(std::span<const BumpUse> uses, Scene& scene) {
    std::vector<bool> converted(uses.size());
    std::map<int32_t, bool> has_normals;                 // by image
    std::map<std::pair<int32_t, char>, int32_t> numbers; // the first use of a channel decides how its edges go on
    std::set<int32_t> heights;
    for (std::size_t i = 0; i < uses.size(); ++i) {
        TextureRef& ref = scene.materials[uses[i].material].normal_texture;
        if (!ref.has_image()) continue;
        const auto [is_normals, is_first] = has_normals.try_emplace(ref.image, false);
        const TextureImage& image = scene.images[static_cast<std::size_t>(ref.image)];
        if (is_first) is_normals->second = looks_like_normals(image);
        if (is_normals->second) continue;
        converted[i] = true;
        heights.insert(ref.image);
        const char channel = is_color_channel(uses[i].channel) ? uses[i].channel : 'm';
        const auto [number, is_new] = numbers.try_emplace({ref.image, channel}, kNoImage);
        if (is_new) {
            number->second = static_cast<int32_t>(scene.images.size());
            scene.images.push_back(normals_of_heights(image, channel, ref.wrap_s));
        }
        ref.image = number->second;
    }
    remove_unused(heights, scene);
    return converted;
}

} // namespace pertev
