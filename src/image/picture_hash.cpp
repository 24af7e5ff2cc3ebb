#include "image/picture_hash.h"

#include "base/error.h"

namespace pertev {

Hash128 picture_hash(const Image& picture) {
    PERTEV_CHECK(picture.channels >= 1 && picture.channels <= 4);
    PERTEV_CHECK(picture.pixels.size() == std::size_t(picture.width) * picture.height * picture.channels);
    Hasher hasher;
    hasher.add_value(picture.width);
    hasher.add_value(picture.height);
    if (picture.channels >= 3) {
        hasher.add_values(std::span<const float>(picture.pixels));
        return hasher.result();
    }
    for (std::size_t i = 0; i < picture.pixels.size(); i += picture.channels) {
        const float y = picture.pixels[i];
        const float values[4] = {y, y, y, picture.channels == 2 ? picture.pixels[i + 1] : 0.0f};
        hasher.add_values(std::span<const float>(values, picture.channels + 2));
    }
    return hasher.result();
}

} // namespace pertev
