#include "formats/described/make_texture.h"

namespace pertev::described {

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
