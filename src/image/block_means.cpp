#include "image/block_means.h"

#include "base/error.h"
#include "math/scalar.h"

namespace pertev {

Image block_means(const Image& image, uint32_t side) {
    PERTEV_CHECK(side >= 1);
    Image means{(image.width + side - 1) / side, (image.height + side - 1) / side, image.channels, {}};
    means.pixels.reserve(std::size_t(means.width) * means.height * means.channels);
    for (uint32_t block_y = 0; block_y < image.height; block_y += side) {
        for (uint32_t block_x = 0; block_x < image.width; block_x += side) {
            const uint32_t end_x = min(block_x + side, image.width), end_y = min(block_y + side, image.height);
            for (uint32_t c = 0; c < image.channels; ++c) {
                double sum = 0;
                for (uint32_t y = block_y; y < end_y; ++y) {
                    for (uint32_t x = block_x; x < end_x; ++x) {
                        sum +=
                            static_cast<double>(image.pixels[(std::size_t(y) * image.width + x) * image.channels + c]);
                    }
                }
                means.pixels.push_back(static_cast<float>(sum / (double(end_x - block_x) * (end_y - block_y))));
            }
        }
    }
    return means;
}

} // namespace pertev
