#include <doctest/doctest.h>

#include <cstring>
#include <vector>

#include <png.h>
#include <zlib.h>

#include "base/error.h"
#include "base/parallel_for.h"
#include "image/decode_image.h"
#include "image/write_png.h"

using namespace pertev;

namespace {

struct PngSource {
    uint32_t width = 0, height = 0;
    int bit_depth = 8, colour_type = PNG_COLOR_TYPE_RGB;
    bool interlaced = false;
    std::vector<png_color> palette = {};
    std::vector<png_byte> palette_alpha = {};
    int transparent_grey = -1;
    std::vector<std::vector<png_byte>> rows = {}; // packed as PNG stores them
};

std::vector<std::byte> make_png(const PngSource& from) {
    std::vector<std::byte> bytes;
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
    png_infop info = png_create_info_struct(png);
    png_set_write_fn(
        png, &bytes,
        [](png_structp p, png_bytep data, std::size_t count) {
            auto& to = *static_cast<std::vector<std::byte>*>(png_get_io_ptr(p));
            to.insert(to.end(), reinterpret_cast<std::byte*>(data), reinterpret_cast<std::byte*>(data) + count);
        },
        nullptr);
    png_set_IHDR(png, info, from.width, from.height, from.bit_depth, from.colour_type,
                 from.interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
                 PNG_FILTER_TYPE_DEFAULT);
    if (!from.palette.empty()) png_set_PLTE(png, info, from.palette.data(), static_cast<int>(from.palette.size()));
    if (!from.palette_alpha.empty())
        png_set_tRNS(png, info, from.palette_alpha.data(), static_cast<int>(from.palette_alpha.size()), nullptr);
    if (from.transparent_grey >= 0) {
        png_color_16 colour = {};
        colour.gray = static_cast<png_uint_16>(from.transparent_grey);
        png_set_tRNS(png, info, nullptr, 0, &colour);
    }
    png_write_info(png, info);
    std::vector<png_bytep> rows;
    for (const auto& row : from.rows) rows.push_back(const_cast<png_bytep>(row.data()));
    png_write_image(png, rows.data());
    png_write_end(png, info);
    png_destroy_write_struct(&png, &info);
    return bytes;
}

std::vector<uint8_t> decode_rgba8(const PngSource& from) {
    const auto image = std::get<Rgba8Image>(decode_image(make_png(from), "t.png"));
    CHECK(image.width == from.width);
    CHECK(image.height == from.height);
    return image.pixels;
}

using Bytes = std::vector<uint8_t>;

} // namespace

TEST_CASE("an RGB PNG becomes opaque RGBA with the bytes of the file") {
    CHECK(decode_rgba8({.width = 2, .height = 1, .rows = {{1, 2, 3, 250, 251, 252}}}) ==
          Bytes{1, 2, 3, 255, 250, 251, 252, 255});
}

TEST_CASE("an RGBA PNG keeps its alpha") {
    CHECK(decode_rgba8({.width = 1, .height = 1, .colour_type = PNG_COLOR_TYPE_RGB_ALPHA, .rows = {{9, 8, 7, 6}}}) ==
          Bytes{9, 8, 7, 6});
}

TEST_CASE("grey PNGs of 1, 2, 4 and 8 bits are scaled to the full range and repeated over R, G, B") {
    CHECK(
        decode_rgba8({.width = 2, .height = 1, .bit_depth = 1, .colour_type = PNG_COLOR_TYPE_GRAY, .rows = {{0x40}}}) ==
        Bytes{0, 0, 0, 255, 255, 255, 255, 255});
    CHECK(
        decode_rgba8({.width = 2, .height = 1, .bit_depth = 2, .colour_type = PNG_COLOR_TYPE_GRAY, .rows = {{0x60}}}) ==
        Bytes{85, 85, 85, 255, 170, 170, 170, 255});
    CHECK(
        decode_rgba8({.width = 2, .height = 1, .bit_depth = 4, .colour_type = PNG_COLOR_TYPE_GRAY, .rows = {{0x1f}}}) ==
        Bytes{17, 17, 17, 255, 255, 255, 255, 255});
    CHECK(decode_rgba8({.width = 1, .height = 1, .colour_type = PNG_COLOR_TYPE_GRAY, .rows = {{77}}}) ==
          Bytes{77, 77, 77, 255});
    CHECK(decode_rgba8({.width = 1, .height = 1, .colour_type = PNG_COLOR_TYPE_GRAY_ALPHA, .rows = {{77, 3}}}) ==
          Bytes{77, 77, 77, 3});
}

TEST_CASE("a palette PNG is expanded with the palette's alpha") {
    CHECK(decode_rgba8({.width = 3,
                        .height = 1,
                        .bit_depth = 2,
                        .colour_type = PNG_COLOR_TYPE_PALETTE,
                        .palette = {{10, 11, 12}, {20, 21, 22}, {30, 31, 32}},
                        .palette_alpha = {5},
                        .rows = {{0b10'00'01'00}}}) == Bytes{30, 31, 32, 255, 10, 11, 12, 5, 20, 21, 22, 255});
}

TEST_CASE("a grey level marked as transparent gets alpha 0") {
    CHECK(decode_rgba8({.width = 2,
                        .height = 1,
                        .colour_type = PNG_COLOR_TYPE_GRAY,
                        .transparent_grey = 50,
                        .rows = {{50, 51}}}) == Bytes{50, 50, 50, 0, 51, 51, 51, 255});
}

TEST_CASE("an interlaced PNG decodes to the same pixels as a plain one") {
    PngSource source{.width = 13, .height = 11};
    for (uint32_t y = 0; y < source.height; ++y) {
        auto& row = source.rows.emplace_back();
        for (uint32_t i = 0; i < source.width * 3; ++i) row.push_back(static_cast<png_byte>(y * 37 + i * 5));
    }
    const Bytes plain = decode_rgba8(source);
    source.interlaced = true;
    CHECK(decode_rgba8(source) == plain);
}

TEST_CASE("a 16-bit PNG keeps its precision and its channels") {
    const auto decode = [](int colour_type, std::vector<png_byte> row) {
        return std::get<Image>(decode_image(
            make_png({.width = 1, .height = 1, .bit_depth = 16, .colour_type = colour_type, .rows = {std::move(row)}}),
            "t.png"));
    };
    const Image rgb = decode(PNG_COLOR_TYPE_RGB, {0x80, 0x01, 0, 0, 0xff, 0xff});
    CHECK(rgb.channels == 3);
    CHECK(rgb.pixels == std::vector<float>{32769.0f / 65535.0f, 0, 1});
    CHECK(decode(PNG_COLOR_TYPE_GRAY, {0, 1}).pixels == std::vector<float>{1.0f / 65535.0f});
    CHECK(decode(PNG_COLOR_TYPE_GRAY_ALPHA, {0, 1, 0, 2}).channels == 2);
    CHECK(decode(PNG_COLOR_TYPE_RGB_ALPHA, {0, 1, 0, 2, 0, 3, 0, 4}).pixels.back() == 4.0f / 65535.0f);
}

TEST_CASE("a written PNG reads back to the same pixels, with and without alpha, and has the same bytes each time") {
    Rgba8Image image{5, 3, {}};
    for (int i = 0; i < 5 * 3 * 4; ++i) image.pixels.push_back(static_cast<uint8_t>(i * 29));
    const auto with_alpha = encode_png(image, true);
    CHECK(std::get<Rgba8Image>(decode_image(with_alpha, "t.png")).pixels == image.pixels);
    CHECK(encode_png(image, true) == with_alpha);

    const auto opaque = std::get<Rgba8Image>(decode_image(encode_png(image), "t.png"));
    for (std::size_t i = 0; i < image.pixels.size(); ++i)
        CHECK(opaque.pixels[i] == (i % 4 == 3 ? 255 : image.pixels[i]));
}

namespace {

/// Returns how many bytes zlib itself reads from the file's only stream, whose checksum it verifies; 0 if the stream is
/// broken.
std::size_t inflated_bytes(const std::vector<std::byte>& file, std::size_t at_most) {
    std::vector<std::byte> stream;
    const auto number_at = [&](std::size_t at) {
        uint32_t number = 0;
        for (std::size_t k = at; k < at + 4; ++k) number = number << 8 | std::to_integer<uint32_t>(file.at(k));
        return number;
    };
    for (std::size_t at = 8; at < file.size(); at += 12 + number_at(at)) {
        if (std::memcmp(&file.at(at + 4), "IDAT", 4) != 0) continue;
        const auto first = file.begin() + static_cast<std::ptrdiff_t>(at + 8);
        stream.insert(stream.end(), first, first + number_at(at));
    }
    std::vector<Bytef> bytes(at_most);
    uLongf size = at_most;
    const int result = uncompress(bytes.data(), &size, reinterpret_cast<const Bytef*>(stream.data()), stream.size());
    return result == Z_OK ? size : 0;
}

} // namespace

TEST_CASE("a PNG written by several threads holds the picture, and its bytes do not depend on them") {
    const auto noise = [](uint32_t width, uint32_t height, uint32_t bits) {
        Rgba8Image image{width, height, {}};
        image.pixels.resize(std::size_t(width) * height * 4);
        uint32_t state = 1;
        for (uint8_t& value : image.pixels) {
            state = state * 1664525u + 1013904223u;
            value = static_cast<uint8_t>(state >> 24 & ((1u << bits) - 1));
        }
        return image;
    };
    struct Case {
        uint32_t width, height, bits; // 8 selects noise, which deflate cannot shorten
    };
    for (const Case& of : {Case{700, 500, 5}, {700, 500, 8}, {700, 500, 1}, {60000, 3, 8}, {1, 40000, 5}}) {
        CAPTURE(of.width);
        CAPTURE(of.bits);
        const Rgba8Image image = noise(of.width, of.height, of.bits);
        const auto whole = encode_png(image, true), opaque = encode_png(image);
        CHECK(std::get<Rgba8Image>(decode_image(whole, "t.png")).pixels == image.pixels);
        const std::size_t bytes = of.height * (1 + std::size_t(of.width) * 3);
        CHECK(inflated_bytes(opaque, bytes + 100) == bytes);
        const auto read = std::get<Rgba8Image>(decode_image(opaque, "t.png"));
        bool is_same = true;
        for (std::size_t i = 0; i < image.pixels.size(); ++i)
            is_same = is_same && read.pixels[i] == (i % 4 == 3 ? 255 : image.pixels[i]);
        CHECK(is_same);
        const UseThreads one(1);
        CHECK(encode_png(image, true) == whole);
        CHECK(encode_png(image) == opaque);
    }
}

TEST_CASE("damage to a PNG's pixels is an error that names the file, and damage to a comment is ignored") {
    std::vector<std::byte> bytes = make_png({.width = 1, .height = 1, .rows = {{1, 2, 3}}});
    const auto at_data = [&] {
        for (std::size_t i = 0; i + 4 <= bytes.size(); ++i)
            if (std::memcmp(bytes.data() + i, "IDAT", 4) == 0) return i;
        return std::size_t(0);
    }();
    REQUIRE(at_data > 0);
    auto damaged = bytes;
    damaged[at_data + 8] ^= std::byte{1};
    try {
        decode_image(damaged, "wall.png");
        FAIL("no error");
    } catch (const Error& error) {
        CHECK(error.code() == ErrorCode::BadInput);
        CHECK(std::string(error.what()).starts_with("wall.png: "));
    }
    // A tEXt chunk with a wrong checksum, before the data.
    const std::string text("\0\0\0\4tEXta\0bc\1\2\3\4", 16);
    auto commented = bytes;
    const std::byte* start = reinterpret_cast<const std::byte*>(text.data());
    commented.insert(commented.begin() + static_cast<std::ptrdiff_t>(at_data) - 4, start, start + text.size());
    CHECK(std::get<Rgba8Image>(decode_image(commented, "t.png")).pixels == Bytes{1, 2, 3, 255});
}
