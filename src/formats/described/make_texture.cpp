#include "formats/described/make_texture.h"

#include "formats/obj/texel_values.h"

namespace pertev::described {
namespace {

/// Returns the mean of the channels; equal ones exactly.
Rgb mean_of(Rgb c) { return c.r == c.g && c.g == c.b ? c : grey((c.r + c.g + c.b) / 3); }

} // namespace

TextureValue as_number(TextureValue value, GreyOf grey_of) {
    value.factor = mean_of(value.factor);
    value.offset = mean_of(value.offset);
    if (value.has_image() && value.grey_of == GreyOf::Channels) value.grey_of = grey_of;
    return value;
}

bool has_colors(const TextureImage& image) {
    for (std::size_t i = 0; i < pixel_count(image); ++i) {
        const float first = texel_value(image, i, 0);
        if (texel_value(image, i, 1) != first || texel_value(image, i, 2) != first) return true;
    }
    return false;
}

TextureValue product(const TextureValue& a, const TextureValue& b) {
    if (!a.varies()) return b.scaled(a.factor);
    return a.scaled(b.has_image() ? b.factor + b.offset : b.factor);
}

TextureImage checks_of(Rgb even, Rgb odd) {
    TextureImage image;
    image.name = "checkerboard";
    image.rgba_float = {.width = 2, .height = 2, .channels = 4, .pixels = {}};
    for (const Rgb color : {odd, even, even, odd}) {
        for (const float channel : {color.r, color.g, color.b, 1.0f}) image.rgba_float.pixels.push_back(channel);
    }
    return image;
}

} // namespace pertev::described
