#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

#include "shading/texture_lookup.h"

using namespace pertev;

namespace {

std::array<float, 256> make_srgb_table() {
    std::array<float, 256> table{};
    for (std::size_t i = 0; i < 256; ++i) {
        const double x = static_cast<double>(i) / 255.0;
        table[i] = static_cast<float>(x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4));
    }
    return table;
}

const std::array<float, 256> kLinearFromSrgb = make_srgb_table();

TextureImage random_rgba8(uint32_t width, uint32_t height, uint32_t seed) {
    TextureImage image;
    image.rgba8 = {width, height, std::vector<uint8_t>(std::size_t(4) * width * height)};
    std::mt19937 random(seed);
    for (uint8_t& value : image.rgba8.pixels) value = static_cast<uint8_t>(random() & 255u);
    return image;
}

/// The image converted to floats.
TextureImage as_float(const TextureImage& source) {
    TextureImage image;
    image.rgba_float = {source.rgba8.width, source.rgba8.height, 4, {}};
    for (const uint8_t value : source.rgba8.pixels) {
        image.rgba_float.pixels.push_back(static_cast<float>(value) * (1.0f / 255.0f));
    }
    return image;
}

Vec4 look_up(const TextureImage& image, const TextureRef& ref, Vec2 uv) {
    const TextureImageView view = view_of(image);
    return lookup_texture(&view, ref, uv, kLinearFromSrgb.data());
}

/// Returns the index that a wrap mode maps texel i to, by the definition of an infinitely repeated image.
int64_t wrapped_index(int64_t i, Wrap wrap, int64_t size) {
    const int64_t period = wrap == Wrap::MirroredRepeat ? 2 * size : size;
    if (wrap == Wrap::ClampToEdge) return std::min(std::max(i, int64_t(0)), size - 1);
    const int64_t r = ((i % period) + period) % period;
    return r < size ? r : period - 1 - r;
}

std::array<double, 4> texel_in_double(const TextureImage& image, const TextureRef& ref, int64_t x, int64_t y) {
    const Rgba8Image& pixels = image.rgba8;
    const auto column = static_cast<std::size_t>(wrapped_index(x, ref.wrap_s, pixels.width));
    const auto row = static_cast<std::size_t>(wrapped_index(y, ref.wrap_t, pixels.height));
    std::array<double, 4> value{};
    for (std::size_t c = 0; c < 4; ++c) {
        const uint8_t encoded = pixels.pixels[4 * (row * pixels.width + column) + c];
        value[c] = ref.is_srgb && c < 3 ? static_cast<double>(kLinearFromSrgb[encoded]) : encoded / 255.0;
    }
    return value;
}

/// Bilinear lookup by the definition, in double.
std::array<double, 4> reference(const TextureImage& image, const TextureRef& ref, Vec2 uv) {
    const double x = static_cast<double>(uv.x) * image.rgba8.width, y = static_cast<double>(uv.y) * image.rgba8.height;
    if (ref.filter == TextureFilter::Nearest) {
        return texel_in_double(image, ref, static_cast<int64_t>(std::floor(x)), static_cast<int64_t>(std::floor(y)));
    }
    const double left = std::floor(x - 0.5), top = std::floor(y - 0.5);
    std::array<double, 4> sum{};
    for (int64_t dy = 0; dy < 2; ++dy) {
        for (int64_t dx = 0; dx < 2; ++dx) {
            const double wx = x - 0.5 - left, wy = y - 0.5 - top;
            const double weight = (dx == 1 ? wx : 1 - wx) * (dy == 1 ? wy : 1 - wy);
            const auto texel =
                texel_in_double(image, ref, static_cast<int64_t>(left) + dx, static_cast<int64_t>(top) + dy);
            for (std::size_t c = 0; c < 4; ++c) sum[c] += weight * texel[c];
        }
    }
    return sum;
}

constexpr std::array kWraps = {Wrap::Repeat, Wrap::MirroredRepeat, Wrap::ClampToEdge};
constexpr std::array kFilters = {TextureFilter::Nearest, TextureFilter::Linear};

} // namespace

TEST_CASE("texture: every wrap mode and filter agrees with its definition in double") {
    const TextureImage image = random_rgba8(7, 5, 1);
    std::mt19937 random(2);
    std::uniform_real_distribution<float> coordinate(-3.5f, 3.5f);
    double worst = 0;
    for (const Wrap wrap_s : kWraps) {
        for (const Wrap wrap_t : kWraps) {
            for (const TextureFilter filter : kFilters) {
                for (const bool is_srgb : {false, true}) {
                    TextureRef ref;
                    ref.image = 0;
                    ref.wrap_s = wrap_s;
                    ref.wrap_t = wrap_t;
                    ref.filter = filter;
                    ref.is_srgb = is_srgb;
                    for (int i = 0; i < 500; ++i) {
                        const float u = coordinate(random);
                        const Vec2 uv = {u, coordinate(random)};
                        const Vec4 got = look_up(image, ref, uv);
                        const std::array<double, 4> want = reference(image, ref, uv);
                        worst = std::max({worst, std::abs(static_cast<double>(got.x) - want[0]),
                                          std::abs(static_cast<double>(got.y) - want[1]),
                                          std::abs(static_cast<double>(got.z) - want[2]),
                                          std::abs(static_cast<double>(got.w) - want[3])});
                    }
                }
            }
        }
    }
    CHECK(worst < 2e-5); // position good to 2^-22, times 7 texels, times a difference of 1
}

TEST_CASE("texture: sRGB is decoded before filtering") {
    TextureImage image;
    image.rgba8 = {2, 1, {0, 0, 0, 0, 255, 255, 255, 255}};
    TextureRef ref;
    ref.image = 0;
    ref.is_srgb = true;
    const Vec4 middle = look_up(image, ref, {0.5f, 0.5f});
    CHECK(middle == Vec4{0.5f, 0.5f, 0.5f, 0.5f});
}

TEST_CASE("texture: the ends of the 8-bit range are exactly 0 and 1") {
    TextureImage image;
    image.rgba8 = {1, 1, {255, 0, 255, 255}};
    TextureRef ref;
    ref.image = 0;
    CHECK(look_up(image, ref, {0.3f, -17.6f}) == Vec4{1, 0, 1, 1});
    ref.is_srgb = true;
    CHECK(look_up(image, ref, {0.3f, -17.6f}) == Vec4{1, 0, 1, 1});
}

TEST_CASE("texture: a slot without an image reads white") {
    const TextureRef ref;
    CHECK(lookup_texture(nullptr, ref, {0.5f, 0.5f}, nullptr) == Vec4{1, 1, 1, 1});
    CHECK(lookup_texture_channel(nullptr, ref, {0.5f, 0.5f}, nullptr) == 1);
}

TEST_CASE("texture: a repeated image is the same to the bit after a thousand repeats") {
    const TextureImage image = random_rgba8(64, 64, 3);
    TextureRef ref;
    ref.image = 0;
    for (int i = 0; i < 1000; ++i) {
        const Vec2 uv = {static_cast<float>(i) / 1024.0f, static_cast<float>(1000 - i) / 1024.0f};
        ref.wrap_s = ref.wrap_t = Wrap::Repeat;
        CHECK(look_up(image, ref, uv) == look_up(image, ref, {uv.x + 1001, uv.y + 1000}));
        ref.wrap_s = ref.wrap_t = Wrap::MirroredRepeat;
        CHECK(look_up(image, ref, uv) == look_up(image, ref, {uv.x + 1000, uv.y - 1000}));
    }
}

TEST_CASE("texture: any float is a valid coordinate, and the value stays within the image's range") {
    const float big = std::numeric_limits<float>::max(), tiny = std::numeric_limits<float>::denorm_min();
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const std::vector<float> coordinates = {nan,   kInfinity, -kInfinity, big,      -big,           1e10f, -1e10f,
                                            tiny,  -tiny,     1,          -0.0f,    0x1.fffffep-1f, 2,     -1,
                                            1e-8f, -1e-8f,    16777217.f, -8388609, 0.5f,           -2};
    for (const uint32_t side : {1u, 3u, 256u}) {
        const TextureImage image = random_rgba8(side, side, side);
        for (const Wrap wrap : kWraps) {
            for (const TextureFilter filter : kFilters) {
                TextureRef ref;
                ref.image = 0;
                ref.wrap_s = ref.wrap_t = wrap;
                ref.filter = filter;
                for (const float u : coordinates) {
                    for (const float v : coordinates) {
                        const Vec4 value = look_up(image, ref, {u, v});
                        CHECK(value.x >= -1e-6f);
                        CHECK(value.x <= 1 + 1e-6f);
                    }
                }
            }
        }
    }
}

TEST_CASE("texture: the lookup of one channel equals that component of the whole lookup") {
    const TextureImage bytes = random_rgba8(5, 9, 4), floats = as_float(bytes);
    const std::array<TextureImageView, 2> views = {view_of(bytes), view_of(floats)};
    std::mt19937 random(5);
    std::uniform_real_distribution<float> coordinate(-2, 2);
    for (int i = 0; i < 2000; ++i) {
        TextureRef ref;
        ref.image = i & 1;
        ref.is_srgb = (i & 2) != 0;
        ref.filter = kFilters[(i >> 2) & 1];
        ref.wrap_s = kWraps[static_cast<std::size_t>(i) % 3];
        ref.channel = static_cast<uint8_t>((i >> 3) & 3);
        const float u = coordinate(random);
        const Vec2 uv = {u, coordinate(random)};
        const Vec4 whole = lookup_texture(views.data(), ref, uv, kLinearFromSrgb.data());
        const float components[4] = {whole.x, whole.y, whole.z, whole.w};
        CHECK(lookup_texture_channel(views.data(), ref, uv, kLinearFromSrgb.data()) == components[ref.channel]);
    }
}

TEST_CASE("texture: a float image reads as the 8-bit image with the same linear values") {
    const TextureImage bytes = random_rgba8(6, 4, 6), floats = as_float(bytes);
    TextureRef ref;
    ref.image = 0;
    for (int i = 0; i < 200; ++i) {
        const Vec2 uv = {static_cast<float>(i) * 0.0137f, static_cast<float>(i) * -0.0291f};
        CHECK(look_up(bytes, ref, uv) == look_up(floats, ref, uv));
    }
}

TEST_CASE("texture: the coordinate transform is applied before the lookup") {
    const TextureImage image = random_rgba8(16, 16, 7);
    TextureRef plain, turned;
    plain.image = turned.image = 0;
    turned.m00 = 0, turned.m01 = 2, turned.m02 = 0.25f; // u' = 2 v + 1/4
    turned.m10 = -1, turned.m11 = 0, turned.m12 = 0.5f; // v' = -u + 1/2
    const Vec2 uv = {0.125f, 0.375f};
    CHECK(look_up(image, turned, uv) == look_up(image, plain, {2 * uv.y + 0.25f, -uv.x + 0.5f}));
    CHECK_FALSE(look_up(image, turned, uv) == look_up(image, plain, uv));
}
