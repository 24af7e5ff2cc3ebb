#include "formats/described/surface.h"

#include <map>
#include <tuple>
#include <utility>

#include "base/parallel_for.h"
#include "formats/described/make_texture.h"
#include "formats/obj/texel_values.h"
#include "image/srgb.h"
#include "math/portable_math.h"

namespace pertev::described {
namespace {

bool is_unit(Rgb c) {
    const auto is_within = [](float x) { return x >= 0 && x <= 1; };
    return is_within(c.r) && is_within(c.g) && is_within(c.b);
}

std::array<float, 3> numbers_of(Rgb c) { return {c.r, c.g, c.b}; }

Rgb converted(Curve curve, float amount, Rgb c) {
    return {converted(curve, amount, c.r), converted(curve, amount, c.g), converted(curve, amount, c.b)};
}

/// Sets the texture of a slot. Returns the factor that the slot's number keeps.
Rgb put_image(Surface& surface, TextureSlot slot, const TextureValue& value, Curve curve, float amount) {
    surface.material.*slot = value.ref;
    std::erase_if(surface.images, [slot](const SlotImage& earlier) { return earlier.slot == slot; });
    SlotImage image{.slot = slot, .made = value.made, .change = {}, .mapping = value.mapping};
    image.change.exponent = value.exponent;
    image.change.grey_of = value.grey_of;
    image.change.curve = curve;
    image.change.amount = amount;
    image.change.is_framed = value.is_framed;
    const bool keeps_factor = curve == Curve::None && is_black(value.offset) && is_unit(value.factor);
    if (!keeps_factor) {
        image.change.factor = numbers_of(value.factor);
        image.change.offset = numbers_of(value.offset);
    }
    surface.images.push_back(image);
    return keeps_factor ? value.factor : Rgb{1, 1, 1};
}

/// Returns whether the alpha of some texel is below 1.
bool has_alpha(const TextureImage& image) {
    for (std::size_t i = 0; i < pixel_count(image); ++i) {
        if (texel_value(image, i, 3) < 1) return true;
    }
    return false;
}

uint32_t width_of(const TextureImage& image) { return max(image.rgba8.width, image.rgba_float.width); }
uint32_t height_of(const TextureImage& image) { return max(image.rgba8.height, image.rgba_float.height); }

/// Returns `from` with its colours changed, as floats.
TextureImage changed_image(const TextureImage& from, const ImageChange& change, bool is_srgb) {
    TextureImage to;
    to.name = from.name;
    const bool is_bytes = !from.rgba8.pixels.empty();
    const uint32_t frame = change.is_framed ? 1 : 0, width = width_of(from) + 2 * frame,
                   height = height_of(from) + 2 * frame;
    const std::size_t count = std::size_t{width} * height;
    to.rgba_float = {.width = width, .height = height, .channels = 4, .pixels = std::vector<float>(4 * count)};
    parallel_for(count, 4096, [&](uint64_t i) {
        const uint64_t column = i % width, row = i / width;
        const bool is_frame = frame > 0 && (column == 0 || row == 0 || column + 1 == width || row + 1 == height);
        const std::size_t of = (row - frame) * width_of(from) + column - frame;
        const std::array<float, 3> texel =
            is_frame ? std::array<float, 3>{} : linear_texel(from, of, change, is_bytes && is_srgb);
        for (std::size_t c = 0; c < 3; ++c) {
            const float value = converted(change.curve, change.amount, change.offset[c] + change.factor[c] * texel[c]);
            to.rgba_float.pixels[4 * i + c] = max(value, 0.0f);
        }
        to.rgba_float.pixels[4 * i + 3] = change.is_opaque || is_frame ? 1.0f : texel_value(from, of, 3);
    });
    return to;
}

/// Moves the coordinates of an image into the frame around it.
void move_into_frame(const TextureImage& framed, TextureRef& ref) {
    const auto across = static_cast<float>(width_of(framed)), down = static_cast<float>(height_of(framed));
    const float along_s = (across - 2) / across, along_t = (down - 2) / down;
    ref.m00 *= along_s, ref.m01 *= along_s, ref.m02 = along_s * ref.m02 + 1 / across;
    ref.m10 *= along_t, ref.m11 *= along_t, ref.m12 = along_t * ref.m12 + 1 / down;
}

/// Removes images without a use and renumbers the textures.
void remove_unused(Scene& scene) {
    std::vector<int32_t> renumbered(scene.images.size(), kNoImage);
    std::vector<TextureImage> kept;
    for (Material& material : scene.materials) {
        visit_textures(material, [&](TextureRef& ref, const char*) {
            if (!ref.has_image()) return;
            int32_t& number = renumbered[static_cast<std::size_t>(ref.image)];
            if (number == kNoImage) {
                number = static_cast<int32_t>(kept.size());
                kept.push_back(std::move(scene.images[static_cast<std::size_t>(ref.image)]));
            }
            ref.image = number;
        });
    }
    scene.images = std::move(kept);
}

} // namespace

std::array<float, 3> linear_texel(const TextureImage& from, std::size_t i, const ImageChange& change, bool decodes) {
    if (change.is_alpha) return numbers_of(grey(texel_value(from, i, 3)));
    const auto linear = [&](float value) {
        if (decodes) value = srgb_decode(value);
        return change.exponent != 1 ? pow(max(value, 0.0f), change.exponent) : value;
    };
    const Rgb stored = {texel_value(from, i, 0), texel_value(from, i, 1), texel_value(from, i, 2)};
    if (change.grey_of == GreyOf::EncodedLuminance) return numbers_of(grey(linear(luminance(stored))));
    const Rgb c = {linear(stored.r), linear(stored.g), linear(stored.b)};
    if (change.grey_of == GreyOf::Luminance) return numbers_of(grey(luminance(c)));
    return numbers_of(change.grey_of == GreyOf::Mean ? grey((c.r + c.g + c.b) / 3) : c);
}

float converted(Curve curve, float amount, float value) {
    switch (curve) {
    case Curve::None:
        return value;
    case Curve::RoughnessOfWidth:
        return sqrt(clamp(value, 0.0f, 1.0f));
    case Curve::RoughnessOfRoot:
        return sqrt(sqrt(clamp(value, 0.0f, 1.0f)));
    case Curve::RoughnessOfGlass3:
        return value == 0 ? 0.0f : converted(Curve::RoughnessOfVersion3, amount, value);
    case Curve::RoughnessOfVersion3: {
        const float x = log(max(value, 1e-3f)); // the polynomial of pbrt-v3's documentation
        const float width = 1.62142f + x * (0.819955f + x * (0.1734f + x * (0.0171201f + x * 0.000640711f)));
        return sqrt(clamp(width, 0.0f, 1.0f));
    }
    case Curve::Root:
        return sqrt(max(value, 0.0f));
    case Curve::BeneathCoat: {
        const float albedo = clamp(value, 0.0f, 1.0f), inside = min(amount, 0.9999f);
        return albedo * (1 - inside) / (1 - albedo * inside);
    }
    }
    return value;
}

void set_color(Surface& surface, Rgb MaterialParameters::*color, TextureSlot slot, const TextureValue& value,
               Curve curve, float amount) {
    if (color == &MaterialParameters::base_color) {
        surface.by_normal.reset();
        if (value.by_normal && !value.has_image()) {
            NormalMix mix = *value.by_normal;
            mix.curve = curve, mix.amount = amount;
            surface.by_normal = std::make_shared<NormalMix>(mix);
            surface.material.base_color = grey(1); // times the colours of the vertices
            return;
        }
    }
    surface.material.*color =
        value.has_image() ? put_image(surface, slot, value, curve, amount) : converted(curve, amount, value.factor);
}

void set_number(Surface& surface, float MaterialParameters::*number, TextureSlot slot, const TextureValue& texture,
                Curve curve) {
    const TextureValue value = as_number(texture);
    if (!value.has_image()) {
        surface.material.*number = converted(curve, 0.0f, value.factor.r);
        return;
    }
    surface.material.*number = put_image(surface, slot, value, curve, 0).r;
    surface.images.back().change.decodes = value.ref.is_srgb;
}

void set_alpha(Surface& surface, const TextureValue& texture) {
    const TextureValue value = as_number(texture);
    Material& material = surface.material;
    if (!value.has_image()) {
        material.alpha *= clamp(value.factor.r, 0.0f, 1.0f);
        if (material.alpha < 1) material.alpha_mode = AlphaMode::Blend;
        return;
    }
    material.alpha *= put_image(surface, &MaterialParameters::alpha_texture, value, Curve::None, 0).r;
    surface.images.back().change.is_alpha = !value.ignores_alpha;
    surface.images.back().change.decodes = value.ref.is_srgb;
    material.alpha_mode = AlphaMode::Blend;
}

void finish_images(const std::vector<const Surface*>& surfaces, std::vector<TextureImage>& made, ImageBudget& budget,
                   Scene& scene) {
    const auto first_made = static_cast<int32_t>(scene.images.size());
    for (TextureImage& image : made) scene.images.push_back(std::move(image));
    std::map<std::tuple<int32_t, bool, ImageChange>, int32_t> numbers;
    std::map<int32_t, bool> with_alpha, with_colors; // by image: many materials may use one
    const auto known = [&](std::map<int32_t, bool>& answers, int32_t image, bool (*asks)(const TextureImage&)) {
        const auto [answer, is_new] = answers.try_emplace(image, false);
        if (is_new) answer->second = asks(scene.images[static_cast<std::size_t>(image)]);
        return answer->second;
    };
    for (std::size_t i = 0; i < surfaces.size(); ++i) {
        for (const SlotImage& use : surfaces[i]->images) {
            TextureRef& ref = scene.materials[i].*use.slot;
            if (use.made >= 0) ref.image = first_made + use.made;
            if (!ref.has_image()) continue;
            const TextureImage& image = scene.images[static_cast<std::size_t>(ref.image)];
            ImageChange change = use.change;
            if (image.rgba8.pixels.empty()) change.decodes = false;
            if (change.is_alpha) change.is_alpha = known(with_alpha, ref.image, has_alpha);
            if (change.is_alpha || (change.grey_of != GreyOf::Channels && !known(with_colors, ref.image, has_colors)))
                change.grey_of = GreyOf::Channels;
            if (change.is_alpha) {
                change.decodes = false;
                if (change == ImageChange{.is_alpha = true}) {
                    ref.channel = 3;
                    continue;
                }
            }
            // The colour's alpha would count as an opacity.
            change.is_opaque = use.slot == &MaterialParameters::base_color_texture &&
                               scene.materials[i].alpha_mode != AlphaMode::Opaque &&
                               known(with_alpha, ref.image, has_alpha);
            if (change.is_identity()) continue;
            const auto [number, is_new] = numbers.try_emplace({ref.image, ref.is_srgb, change}, kNoImage);
            if (is_new) {
                budget.charge(scene.images[static_cast<std::size_t>(ref.image)]);
                number->second = static_cast<int32_t>(scene.images.size());
                scene.images.push_back(
                    changed_image(scene.images[static_cast<std::size_t>(ref.image)], change, ref.is_srgb));
            }
            ref.image = number->second;
            if (change.is_framed) move_into_frame(scene.images[static_cast<std::size_t>(ref.image)], ref);
        }
    }
    remove_unused(scene);
}

} // namespace pertev::described
