#include <doctest/doctest.h>

#include <cstdio>
#include <cstdlib>
#include <vector>

#include <jpeglib.h>

#include "base/error.h"
#include "image/decode_image.h"
#include "image/write_jpeg.h"
#include "tests/support/thrown_error.h"

using namespace pertev;

namespace {

struct JpegSource {
    J_COLOR_SPACE in = JCS_GRAYSCALE, stored = JCS_GRAYSCALE;
    int components = 1;
    bool adobe_marker = false, progressive = false, scan_per_component = false;
    std::vector<unsigned char> pixel = {}; // repeated over 20 x 10 pixels
};

std::vector<std::byte> make_jpeg(const JpegSource& from) {
    jpeg_compress_struct info = {};
    jpeg_error_mgr errors = {};
    info.err = jpeg_std_error(&errors);
    jpeg_create_compress(&info);
    unsigned char* bytes = nullptr;
    unsigned long count = 0;
    jpeg_mem_dest(&info, &bytes, &count);
    info.image_width = 20;
    info.image_height = 10;
    info.input_components = from.components;
    info.in_color_space = from.in;
    jpeg_set_defaults(&info);
    jpeg_set_colorspace(&info, from.stored);
    info.write_Adobe_marker = from.adobe_marker ? TRUE : FALSE;
    jpeg_set_quality(&info, 100, TRUE);
    if (from.progressive) jpeg_simple_progression(&info);
    const jpeg_scan_info scans[3] = {{1, {0}, 0, 63, 0, 0}, {1, {1}, 0, 63, 0, 0}, {1, {2}, 0, 63, 0, 0}};
    if (from.scan_per_component) {
        info.scan_info = scans;
        info.num_scans = 3;
    }
    jpeg_start_compress(&info, TRUE);
    std::vector<unsigned char> row;
    for (int x = 0; x < 20; ++x) row.insert(row.end(), from.pixel.begin(), from.pixel.end());
    while (info.next_scanline < info.image_height) {
        JSAMPROW rows[1] = {row.data()};
        jpeg_write_scanlines(&info, rows, 1);
    }
    jpeg_finish_compress(&info);
    jpeg_destroy_compress(&info);
    const std::byte* start = reinterpret_cast<const std::byte*>(bytes);
    std::vector<std::byte> result(start, start + count);
    std::free(bytes);
    return result;
}

void check_is_filled_with(const std::vector<std::byte>& bytes, std::vector<int> rgba) {
    const auto image = std::get<Rgba8Image>(decode_image(bytes, "t.jpg"));
    CHECK(image.width == 20);
    CHECK(image.height == 10);
    for (std::size_t i = 0; i < image.pixels.size(); ++i) CHECK(std::abs(image.pixels[i] - rgba[i % 4]) <= 1);
}

} // namespace

TEST_CASE("a grey JPEG is repeated over R, G, B and opaque") {
    check_is_filled_with(make_jpeg({.pixel = {77}}), {77, 77, 77, 255});
}

TEST_CASE("colour JPEGs decode to their colours, baseline and progressive, as YCbCr and as RGB") {
    for (const bool progressive : {false, true}) {
        for (const J_COLOR_SPACE stored : {JCS_YCbCr, JCS_RGB}) {
            check_is_filled_with(make_jpeg({.in = JCS_RGB,
                                            .stored = stored,
                                            .components = 3,
                                            .adobe_marker = stored == JCS_RGB,
                                            .progressive = progressive,
                                            .pixel = {200, 100, 50}}),
                                 {200, 100, 50, 255});
        }
    }
}

TEST_CASE("CMYK and YCCK JPEGs become RGB, and with Adobe's marker 255 is no ink") {
    // The inks transmit (1, 0.6, 0.2), times 0.8 for black.
    const std::vector<unsigned char> no_ink_is_255 = {255, 153, 51, 204}, no_ink_is_0 = {0, 102, 204, 51};
    JpegSource source{.in = JCS_CMYK, .stored = JCS_CMYK, .components = 4, .pixel = no_ink_is_0};
    check_is_filled_with(make_jpeg(source), {204, 122, 41, 255});
    source.adobe_marker = true;
    source.pixel = no_ink_is_255;
    check_is_filled_with(make_jpeg(source), {204, 122, 41, 255});
    source.stored = JCS_YCCK;
    check_is_filled_with(make_jpeg(source), {204, 122, 41, 255});
}

TEST_CASE("a written JPEG is close to the picture and drops its alpha") {
    Rgba8Image image{32, 24, {}};
    for (int y = 0; y < 24; ++y)
        for (int x = 0; x < 32; ++x)
            for (const int value : {x * 7, y * 9, 255 - x * 4, 13}) image.pixels.push_back(static_cast<uint8_t>(value));
    const auto back = std::get<Rgba8Image>(decode_image(encode_jpeg(image), "t.jpg"));
    REQUIRE(back.pixels.size() == image.pixels.size());
    for (std::size_t i = 0; i < image.pixels.size(); ++i)
        CHECK(std::abs(back.pixels[i] - (i % 4 == 3 ? 255 : image.pixels[i])) <= 8);
}

TEST_CASE("a truncated JPEG is an error, not a picture with a grey end") {
    std::vector<std::byte> bytes = make_jpeg({.pixel = {77}});
    for (const std::size_t left : {bytes.size() - 2, bytes.size() - 8, bytes.size() / 2, std::size_t(3)}) {
        const auto error = test::thrown_error([&] { decode_image(std::span(bytes).first(left), "floor.jpg"); });
        CHECK(test::is_at(error, ErrorCode::BadInput, {"floor.jpg"}));
    }
}

TEST_CASE("a JPEG with very many scans is refused, because each scan costs the whole picture") {
    const std::vector<std::byte> bytes = make_jpeg(
        {.in = JCS_RGB, .stored = JCS_YCbCr, .components = 3, .scan_per_component = true, .pixel = {200, 100, 50}});
    check_is_filled_with(bytes, {200, 100, 50, 255});
    const auto is_scan = [&](std::size_t i) { return bytes[i] == std::byte{0xff} && bytes[i + 1] == std::byte{0xda}; };
    std::size_t last_scan = bytes.size() - 2;
    while (!is_scan(last_scan)) --last_scan;
    const auto begin = bytes.begin() + static_cast<std::ptrdiff_t>(last_scan), end = bytes.end() - 2; // before EOI
    std::vector<std::byte> many = bytes;
    for (int k = 0; k < 200; ++k) many.insert(many.end() - 2, begin, end);
    CHECK(test::thrown_error([&] { decode_image(many, "slow.jpg"); }).has_value());
}

TEST_CASE("the writer refuses a JPEG wider than the format allows") {
    Rgba8Image image{65535, 1, std::vector<uint8_t>(65535 * 4)};
    CHECK_THROWS_AS(encode_jpeg(image), Error);
    const auto error = test::thrown_error([] { check_jpeg_size({"size", "1x65501", ""}, 1, 65501); });
    CHECK(test::is_about(error, ErrorCode::OverLimit, "size", "1x65501"));
    CHECK_NOTHROW(check_jpeg_size("", 65500, 65500));
}

TEST_CASE("strips encoded in parallel decode to the pixels of the picture encoded at once") {
    // Sizes that end inside a block, a single strip, and more strips than there are restart numbers.
    for (const auto& [width, height] :
         {std::pair{1u, 1u}, {7u, 9u}, {64u, 8u}, {61u, 250u}, {333u, 517u}, {9000u, 70u}}) {
        CAPTURE(width);
        CAPTURE(height);
        Rgba8Image picture = {width, height, std::vector<uint8_t>(std::size_t(width) * height * 4)};
        for (std::size_t i = 0; i < picture.pixels.size(); ++i) {
            picture.pixels[i] = static_cast<uint8_t>((i * 7 + i / 97 * 31 + i / (4 * width) * 3) & 0xff);
        }
        for (const int quality : {35, 90}) {
            const Rgba8Image strips =
                std::get<Rgba8Image>(decode_image(encode_jpeg_strips(picture, quality, false), "strips.jpg"));
            const Rgba8Image whole = std::get<Rgba8Image>(decode_image(encode_jpeg(picture, quality), "whole.jpg"));
            CHECK(strips.width == width);
            CHECK(strips.height == height);
            CHECK(strips.pixels == whole.pixels);
            const std::vector<std::byte> half_way = encode_jpeg_strips(picture, quality, true);
            CHECK(std::get<Rgba8Image>(decode_image(half_way, "half_way.jpg")).height == height);
        }
    }
}
