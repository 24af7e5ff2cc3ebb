#include "image/picture_hash.h"

#include "base/error.h"

namespace pertev {

Hash128 picture_hash(uint32_t width, uint32_t height, std::span<const float> pixels) {
    Hasher hasher;
    hasher.add_value(width);
    hasher.add_value(height);
    hasher.add_values(pixels);
    return hasher.result();
}

Hash128 picture_hash(const Image& picture) {
    PERTEV_CHECK(picture.channels >= 1 && picture.channels <= 4);
    PERTEV_CHECK(picture.pixels.size() == std::size_t(picture.width) * picture.height * picture.channels);
    if (picture.channels >= 3) return picture_hash(picture.width, picture.height, picture.pixels);
    Hasher hasher;
    hasher.add_value(picture.width);
    hasher.add_value(picture.height);
    for (std::size_t i = 0; i < picture.pixels.size(); i += picture.channels) {
        const float y = picture.pixels[i];
        const float values[4] = {y, y, y, picture.channels == 2 ? picture.pixels[i + 1] : 0.0f};
        hasher.add_values(std::span<const float>(values, picture.channels + 2));
    }
    return hasher.result();
}

} // namespace pertev
