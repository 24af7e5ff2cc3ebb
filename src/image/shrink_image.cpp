#include "image/shrink_image.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "image/srgb.h"
#include "image/srgb_table.h"

namespace pertev {
namespace {

/// Adds up `size` pixels, `stride` apart, as `to` of them, each the mean of an interval of equal length. `load(i)`
/// returns a channel of pixel i, `store(i, mean)` takes that of the new one.
template <class Load, class Store>
void average(uint32_t size, uint32_t to, const Load& load, const Store& store) {
    const double step = static_cast<double>(size) / to;
    for (uint32_t i = 0; i < to; ++i) {
        const double begin = i * step, end = i + 1 == to ? size : (i + 1) * step;
        double sum = 0;
        for (auto k = static_cast<uint32_t>(begin); k < size && k < end; ++k) {
            sum += (std::min(end, k + 1.0) - std::max(begin, static_cast<double>(k))) * static_cast<double>(load(k));
        }
        store(i, static_cast<float>(sum / (end - begin)));
    }
}

/// Returns a picture of `width` x `height`, by rows and then by columns. `load(x, y, channel)` returns a linear value.
template <class Load>
Image averaged(uint32_t from_width, uint32_t from_height, uint32_t channels, std::pair<uint32_t, uint32_t> size,
               const Load& load) {
    const auto [width, height] = size;
    Image rows{width, from_height, channels, std::vector<float>(std::size_t(width) * from_height * channels)};
    Image to{width, height, channels, std::vector<float>(std::size_t(width) * height * channels)};
    for (uint32_t c = 0; c < channels; ++c) {
        for (uint32_t y = 0; y < from_height; ++y) {
            average(
                from_width, width, [&](uint32_t x) { return load(x, y, c); },
                [&](uint32_t x, float mean) { rows.at(x, y)[c] = mean; });
        }
        for (uint32_t x = 0; x < width; ++x) {
            average(
                from_height, height, [&](uint32_t y) { return rows.at(x, y)[c]; },
                [&](uint32_t y, float mean) { to.at(x, y)[c] = mean; });
        }
    }
    return to;
}

} // namespace

std::pair<uint32_t, uint32_t> shrunk_size(uint32_t width, uint32_t height, uint32_t longest) {
    const uint32_t longer = std::max(width, height);
    if (longer <= longest) return {width, height};
    const auto side = [&](uint32_t pixels) {
        return std::max(static_cast<uint32_t>((uint64_t(pixels) * longest + longer / 2) / longer), 1u);
    };
    return {side(width), side(height)};
}

Rgba8Image shrink_image(const Rgba8Image& image, uint32_t longest, bool is_srgb) {
    const auto size = shrunk_size(image.width, image.height, longest);
    if (size == std::pair(image.width, image.height)) return image;
    const std::array<float, 256>& linear = srgb_decode_table();
    const Image mean = averaged(image.width, image.height, 4, size, [&](uint32_t x, uint32_t y, uint32_t c) {
        const uint8_t byte = image.pixels[4 * (std::size_t(y) * image.width + x) + c];
        return is_srgb && c < 3 ? linear[byte] : static_cast<float>(byte) / 255;
    });
    Rgba8Image to{mean.width, mean.height, std::vector<uint8_t>(mean.pixels.size())};
    for (std::size_t i = 0; i < mean.pixels.size(); ++i) {
        to.pixels[i] = to_byte(is_srgb && i % 4 < 3 ? srgb_encode(mean.pixels[i]) : mean.pixels[i]);
    }
    return to;
}

Image shrink_image(const Image& image, uint32_t longest, bool is_srgb) {
    const auto size = shrunk_size(image.width, image.height, longest);
    if (size == std::pair(image.width, image.height)) return image;
    const uint32_t colours = image.channels < 3 ? 1 : 3;
    Image to = averaged(image.width, image.height, image.channels, size, [&](uint32_t x, uint32_t y, uint32_t c) {
        const float value = image.at(x, y)[c];
        return is_srgb && c < colours ? srgb_decode(value) : value;
    });
    if (is_srgb) {
        for (std::size_t i = 0; i < to.pixels.size(); ++i) {
            if (i % image.channels < colours) to.pixels[i] = srgb_encode(to.pixels[i]);
        }
    }
    return to;
}

} // namespace pertev
