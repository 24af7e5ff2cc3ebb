#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "base/error.h"
#include "image/decode_image.h"
#include "image/write_hdr.h"
#include "tests/support/thrown_error.h"

using namespace pertev;

namespace {

Image decode(const std::string& text) {
    return std::get<Image>(decode_image(std::as_bytes(std::span(text)), "sky.hdr"));
}

std::string header(const std::string& size, const std::string& more = "") {
    return "#?RADIANCE\n# made by a test\n" + more + "FORMAT=32-bit_rle_rgbe\n\n" + size + "\n";
}

std::string pixel(int r, int g, int b, int e) {
    return {static_cast<char>(r), static_cast<char>(g), static_cast<char>(b), static_cast<char>(e)};
}

// Returns the red values of the pixels, row by row from the top.
std::vector<float> reds(const Image& image) {
    std::vector<float> result;
    for (std::size_t i = 0; i < image.pixels.size(); i += 3) result.push_back(image.pixels[i]);
    return result;
}

bool is_refused_hdr(const std::string& text) {
    return test::is_at(test::thrown_error([&] { decode(text); }), ErrorCode::BadInput, {"sky.hdr"});
}

} // namespace

TEST_CASE("an RGBE pixel is its mantissa times 2^(exponent - 136), even for the smallest exponents") {
    const Image image = decode(header("-Y 1 +X 4") + pixel(128, 64, 255, 129) + pixel(7, 7, 7, 0) +
                               pixel(255, 1, 2, 1) + pixel(255, 0, 0, 255));
    CHECK(image.pixels == std::vector<float>{1, 0.5f, 255.0f / 128, 0, 0, 0, 255 * 0x1p-135f, 0x1p-135f, 0x1p-134f,
                                             255 * 0x1p119f, 0, 0});
}

TEST_CASE("all eight orientations of a Radiance file put the first pixel in its corner") {
    // Red 1, 2, 3, ... in file order, 3 wide and 2 high.
    std::string pixels;
    for (int i = 1; i <= 6; ++i) pixels += pixel(i, 0, 0, 136);
    const auto decoded = [&](const char* size) { return reds(decode(header(size) + pixels)); };
    using V = std::vector<float>;
    CHECK(decoded("-Y 2 +X 3") == V{1, 2, 3, 4, 5, 6});
    CHECK(decoded("-Y 2 -X 3") == V{3, 2, 1, 6, 5, 4});
    CHECK(decoded("+Y 2 +X 3") == V{4, 5, 6, 1, 2, 3});
    CHECK(decoded("+Y 2 -X 3") == V{6, 5, 4, 3, 2, 1});
    CHECK(decoded("+X 3 -Y 2") == V{1, 3, 5, 2, 4, 6});
    CHECK(decoded("-X 3 -Y 2") == V{5, 3, 1, 6, 4, 2});
    CHECK(decoded("+X 3 +Y 2") == V{2, 4, 6, 1, 3, 5});
    CHECK(decoded("-X 3 +Y 2") == V{6, 4, 2, 5, 3, 1});
}

TEST_CASE("old run-length coding repeats the previous pixel, with several bytes of count") {
    const Image short_run = decode(header("-Y 1 +X 5") + pixel(9, 0, 0, 136) + pixel(1, 1, 1, 3) + pixel(4, 0, 0, 136));
    CHECK(reds(short_run) == std::vector<float>{9, 9, 9, 9, 4});
    const Image long_run =
        decode(header("-Y 1 +X 600") + pixel(9, 0, 0, 136) + pixel(1, 1, 1, 0x57) + pixel(1, 1, 1, 2));
    CHECK(reds(long_run) == std::vector<float>(600, 9.0f)); // 1 + 0x57 + 2 * 256
}

TEST_CASE("new run-length coding holds each channel as runs and plain bytes") {
    std::string line = pixel(2, 2, 0, 8);
    line += "\x88\x05";                                 // red: eight times 5
    line += std::string("\x03\x01\x02\x03\x85\x09", 6); // green: 1 2 3, then five times 9
    line += std::string("\x88\x00", 2);
    line += "\x88\x88"; // exponent 136
    const Image image = decode(header("-Y 1 +X 8") + line);
    CHECK(reds(image) == std::vector<float>(8, 5.0f));
    CHECK(image.at(2, 0)[1] == 3);
    CHECK(image.at(7, 0)[1] == 9);
    CHECK(image.at(7, 0)[2] == 0);
}

TEST_CASE("values are divided by every EXPOSURE line and by COLORCORR") {
    const Image image =
        decode(header("-Y 1 +X 1", "EXPOSURE=2\nEXPOSURE=4\nCOLORCORR=1 2 0.5\n") + pixel(64, 64, 64, 136));
    CHECK(image.pixels == std::vector<float>{8, 4, 16});
}

TEST_CASE("a damaged Radiance file is an error that names the file") {
    CHECK_FALSE(is_refused_hdr(header("-Y 1 +X 1") + "abcd"));
    CHECK(is_refused_hdr(header("-Y 1 +Z 1") + "abcd"));
    CHECK(is_refused_hdr(header("-Y 1 -Y 1") + "abcd"));
    CHECK(is_refused_hdr(header("-Y 0 +X 4")));
    CHECK(is_refused_hdr(header("-Y 1 +X 2") + "abcd"));                         // truncated
    CHECK(is_refused_hdr(header("-Y 1 +X 8") + pixel(2, 2, 0, 9)));              // a row of 9 pixels
    CHECK(is_refused_hdr(header("-Y 1 +X 8") + pixel(2, 2, 0, 8) + "\x89\x01")); // a run beyond the row
    CHECK(is_refused_hdr(header("-Y 1 +X 4") + pixel(1, 1, 1, 4)));              // a repetition before the first pixel
    CHECK(is_refused_hdr("#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\nabcd"));
    CHECK(is_refused_hdr("#?RADIANCE\n\n-Y 1 +X 1\nabcd"));
    CHECK(is_refused_hdr(header("-Y 1 +X 1", "EXPOSURE=0\n") + "abcd"));
}

TEST_CASE("a written HDR reads back within half a unit of its shared exponent") {
    for (const uint32_t width : {3u, 200u}) { // flat, run-length coded
        Image image{width, 3, 3, {}};
        for (uint32_t i = 0; i < width * 9; ++i)
            image.pixels.push_back((i / 40 % 2 != 0 ? 1.0f : 0.37f * static_cast<float>(i)) * 0x1p-3f);
        const Image back = std::get<Image>(decode_image(encode_hdr(image), "t.hdr"));
        REQUIRE(back.pixels.size() == image.pixels.size());
        for (std::size_t i = 0; i < image.pixels.size(); ++i) {
            const std::size_t p = i / 3 * 3;
            const float largest = std::max({image.pixels[p], image.pixels[p + 1], image.pixels[p + 2]});
            CHECK(std::abs(back.pixels[i] - image.pixels[i]) <= largest / 255);
        }
        CHECK(encode_hdr(back) == encode_hdr(image)); // representable values are stored exactly
    }
}

TEST_CASE("an HDR file stores unrepresentable values as the nearest representable ones") {
    const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
    const Image image{4, 1, 3, {nan, -1, 0, inf, 1, 1, 255.7f, 0, 0, 1e-40f, 0, 0}};
    const Image back = std::get<Image>(decode_image(encode_hdr(image), "t.hdr"));
    CHECK(back.pixels == std::vector<float>{0, 0, 0, 255 * 0x1p119f, 0, 0, 256, 0, 0, 0, 0, 0});
}
