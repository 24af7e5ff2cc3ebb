#include <doctest/doctest.h>

#include "image/metrics.h"

using namespace pertev;

TEST_CASE("a picture of block means has one pixel per block, with partial blocks at the border") {
    Image image{5, 3, 3, {}};
    for (uint32_t y = 0; y < 3; ++y) {
        for (uint32_t x = 0; x < 5; ++x) {
            for (const float c : {1.0f, 100.0f, 0.0f}) image.pixels.push_back(c * static_cast<float>(10 * y + x));
        }
    }
    const Image means = block_means(image, 2);
    REQUIRE(means.width == 3);
    REQUIRE(means.height == 2);
    REQUIRE(means.channels == 3);
    CHECK(means.at(0, 0)[0] == 5.5f);   // 0 1 10 11
    CHECK(means.at(1, 0)[1] == 750.0f); // 2 3 12 13, green
    CHECK(means.at(2, 0)[0] == 9.0f);   // 4 14
    CHECK(means.at(0, 1)[0] == 20.5f);  // 20 21
    CHECK(means.at(2, 1)[0] == 24.0f);  // the corner
    CHECK(means.at(2, 1)[2] == 0.0f);
}

TEST_CASE("block means with one pixel per block equal the picture") {
    const Image image{2, 1, 4, {1, 2, 3, 4, 5, 6, 7, 8}};
    CHECK(block_means(image, 1).pixels == image.pixels);
}
