// The order in which samples begin: each sample of each pixel begins once, samples of a pixel are consecutive, and
// samples in flight form an approximate square.

#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <vector>

#include "render/begin_order.h"

namespace pertev {
namespace {

struct Size {
    uint32_t width, height;
};

uint32_t pixel_at(uint32_t index, Size size) {
    return BeginOrder{{.width = size.width, .height = size.height}, 0, 1}.pixel(index);
}

TEST_CASE("every pixel occurs once, even where tiles and bands do not fill the picture") {
    const Size sizes[] = {{1, 1}, {7, 3}, {8, 4}, {64, 64}, {101, 67}, {16, 131}, {200, 9}, {24, 84}, {29, 87}};
    for (const Size size : sizes) {
        CAPTURE(size.width);
        CAPTURE(size.height);
        std::vector<uint32_t> times(std::size_t(size.width) * size.height);
        for (uint32_t index = 0; index < times.size(); ++index) {
            const uint32_t pixel = pixel_at(index, size);
            REQUIRE(pixel < times.size());
            ++times[pixel];
        }
        CHECK(std::ranges::all_of(times, [](uint32_t n) { return n == 1; }));
    }
}

TEST_CASE("32 consecutive pixels are one tile") {
    for (const Size size : {Size{1920, 1080}, Size{101, 67}, Size{29, 87}}) {
        const uint32_t tiled = (size.width / 8) * (size.height / 4) * 32;
        uint32_t apart = 0;
        for (uint32_t index = 0; index < tiled; ++index) {
            const uint32_t first = pixel_at(index / 32 * 32, size);
            const uint32_t pixel = pixel_at(index, size);
            apart += first % size.width / 8 != pixel % size.width / 8 ? 1 : 0;
            apart += first / size.width / 4 != pixel / size.width / 4 ? 1 : 0;
        }
        CHECK(apart == 0);
    }
}

TEST_CASE("samples of a pixel are consecutive, and those of a window are of its pixels") {
    const PixelWindow window = {.picture_width = 120, .x = 11, .y = 5, .width = 101, .height = 67};
    const BeginOrder order = {window, 7, 3};
    CHECK(order.count() == 101 * 67 * 3);
    for (uint64_t number = 0; number < order.count(); ++number) {
        const PixelSample one = order.at(number);
        const uint32_t slot = pixel_at(static_cast<uint32_t>(number) / 3, {101, 67});
        REQUIRE(one.pixel == (5 + slot / 101) * 120 + 11 + slot % 101);
        REQUIRE(one.sample == 7 + number % 3);
    }
}

TEST_CASE("indices beyond 32 bits keep their order") {
    const BeginOrder order = {{.width = 1920, .height = 1080}, 0, 1u << 20};
    const PixelSample last = order.at(order.count() - 1);
    CHECK(last.pixel == pixel_at(1920 * 1080 - 1, {1920, 1080}));
    CHECK(last.sample == (1u << 20) - 1);
}

TEST_CASE("consecutive pixels lie in an approximate square") {
    uint32_t left = 1920, right = 0, top = 1080, bottom = 0;
    for (uint32_t index = 500'000; index < 504'096; ++index) {
        const uint32_t pixel = pixel_at(index, {1920, 1080}), x = pixel % 1920, y = pixel / 1920;
        left = std::min(left, x), right = std::max(right, x), top = std::min(top, y), bottom = std::max(bottom, y);
    }
    CHECK(right - left < 100);
    CHECK(bottom - top < 100);
}

} // namespace
} // namespace pertev
