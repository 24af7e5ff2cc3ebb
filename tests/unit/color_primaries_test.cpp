#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <span>
#include <string>

#include "formats/files/load_textures.h"
#include "image/color_primaries.h"
#include "image/decode_image.h"
#include "image/picture_primaries.h"
#include "image/read_image.h"
#include "image/write_exr.h"
#include "tests/support/options.h"

namespace fs = std::filesystem;
using namespace pertev;

namespace color_primaries_test { // test files are compiled together

constexpr ColorPrimaries kAcesCg = {{0.713, 0.293}, {0.165, 0.830}, {0.128, 0.044}, {0.32168, 0.33767}};
constexpr ColorPrimaries kP3 = {{0.680, 0.320}, {0.265, 0.690}, {0.150, 0.060}, {0.3127, 0.3290}};
constexpr ColorPrimaries kAces = {{0.7347, 0.2653}, {0, 1}, {0.0001, -0.0770}, {0.32168, 0.33767}};
constexpr ColorPrimaries kXyz = {{1, 0}, {0, 1}, {0, 0}, {1.0 / 3, 1.0 / 3}};

void check_matrix(const ColorPrimaries& primaries, const ColorMatrix& right) {
    const std::optional<ColorMatrix> matrix = rec709_from(primaries);
    REQUIRE(matrix);
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) CHECK((*matrix)[i][j] == doctest::Approx(right[i][j]).epsilon(0.001));
}

template <class T>
void append(std::vector<std::byte>& bytes, T value) {
    std::byte raw[sizeof(T)];
    std::memcpy(raw, &value, sizeof(T));
    bytes.insert(bytes.end(), raw, raw + sizeof(T));
}

void append(std::vector<std::byte>& bytes, const char* text) {
    for (; *text != 0; ++text) bytes.push_back(std::byte(*text));
    bytes.push_back(std::byte(0));
}

/// `exr` with an attribute `chromaticities` in its header. Its table of chunks, of one chunk, moves with the pixels.
std::vector<std::byte> with_chromaticities(const std::vector<std::byte>& exr, const ColorPrimaries& p,
                                           const char* type = "chromaticities") {
    std::vector<std::byte> attribute;
    append(attribute, "chromaticities");
    append(attribute, type);
    append(attribute, int32_t(32));
    for (const Chromaticity& c : {p.red, p.green, p.blue, p.white}) {
        append(attribute, float(c.x));
        append(attribute, float(c.y));
    }
    std::vector<std::byte> to(exr.begin(), exr.begin() + 8);
    to.insert(to.end(), attribute.begin(), attribute.end());
    to.insert(to.end(), exr.begin() + 8, exr.end());
    // The table follows the header's zero byte: the position whose eight bytes are the file's size without the
    // chunk.
    for (std::size_t at = to.size() - 8; at > attribute.size() + 8; --at) {
        uint64_t offset = 0;
        std::memcpy(&offset, to.data() + at, 8);
        if (offset + attribute.size() != at + 8) continue;
        offset += attribute.size();
        std::memcpy(to.data() + at, &offset, 8);
        return to;
    }
    throw std::runtime_error("no table of chunks");
}

void check_pixel(const Image& image, std::array<double, 3> right) {
    for (std::size_t c = 0; c < 3; ++c) CHECK(double(image.pixels[c]) == doctest::Approx(right[c]).epsilon(0.001));
}

/// Rec. 709's (.5, .25, .125) in ACEScg.
const Image kPicture = {2, 1, 3, {0.39735f, 0.26587f, 0.14643f, 0.39735f, 0.26587f, 0.14643f}};
constexpr std::array<double, 3> kRight = {0.5, 0.25, 0.125};

TEST_CASE("matrices of ACEScg, P3, ACES 2065-1 and XYZ match the published ones with Bradford's adaptation") {
    check_matrix(kAcesCg,
                 {{{1.70505, -0.62179, -0.08326}, {-0.13026, 1.14080, -0.01055}, {-0.02400, -0.12897, 1.15297}}});
    check_matrix(kP3, {{{1.22494, -0.22494, 0}, {-0.04206, 1.04206, 0}, {-0.01964, -0.07864, 1.09828}}});
    check_matrix(kAces,
                 {{{2.52169, -1.13413, -0.38756}, {-0.27648, 1.37272, -0.09624}, {-0.01538, -0.15298, 1.16835}}});
    // The matrix is sRGB from XYZ under D65, times Bradford's adaptation from E.
    check_matrix(kXyz, {{{3.14666, -1.66646, -0.48019}, {-0.99552, 1.95576, 0.03976}, {0.06359, -0.21456, 1.15097}}});
    CHECK(is_rec709(kRec709));
    CHECK(is_rec709({{0.6400, 0.3300}, {0.3, 0.6}, {0.1500, 0.0600}, {0.31271, 0.32902}}));
    CHECK_FALSE(is_rec709(kP3));
}

TEST_CASE("white stays white for all primaries, and degenerate primaries have no matrix") {
    for (const ColorPrimaries& primaries : {kAcesCg, kP3, kAces, kXyz}) {
        const ColorMatrix matrix = *rec709_from(primaries);
        for (const auto& row : matrix) CHECK(row[0] + row[1] + row[2] == doctest::Approx(1).epsilon(1e-12));
    }
    const double nan = std::numeric_limits<double>::quiet_NaN();
    CHECK(!rec709_from({}));
    CHECK(!rec709_from({{0.64, 0.33}, {0.64, 0.33}, {0.15, 0.06}, {0.3127, 0.3290}}));
    CHECK(!rec709_from({{0.64, 0.33}, {0.30, 0.60}, {0.47, 0.465}, {0.3127, 0.3290}})); // the primaries lie on a line
    CHECK(!rec709_from({{0.64, 0.33}, {0.30, 0.60}, {0.15, 0.06}, {0.9, 0.05}})); // white lies outside the triangle
    CHECK(!rec709_from({{0.64, 0.33}, {0.30, 0.60}, {0.15, 0.06}, {0.3127, 0}})); // black
    CHECK(!rec709_from({{nan, 0.33}, {0.30, 0.60}, {0.15, 0.06}, {0.3127, 0.3290}}));
    CHECK(!rec709_from({{1e30, 0.33}, {0.30, 0.60}, {0.15, 0.06}, {0.3127, 0.3290}}));
}

TEST_CASE("an EXR picture is converted to Rec. 709 when it is used, and kept as stored when it is only decoded") {
    const std::vector<std::byte> plain = encode_exr(kPicture);
    const std::vector<std::byte> bytes = with_chromaticities(plain, kAcesCg);
    Messages messages;
    check_pixel(read_image(bytes, "t.exr", messages), kRight);
    CHECK(std::get<Image>(decode_image(bytes, "t.exr")).pixels == kPicture.pixels);
    CHECK(read_image(plain, "t.exr", messages).pixels ==
          kPicture.pixels); // without the attribute the colours are unchanged
    CHECK(read_image(with_chromaticities(plain, kRec709), "t.exr", messages).pixels == kPicture.pixels);
    CHECK(messages.all().empty());

    const Image with_alpha = {1, 1, 4, {0.39735f, 0.26587f, 0.14643f, 0.5f}};
    const Image read = read_image(with_chromaticities(encode_exr(with_alpha), kAcesCg), "t.exr");
    check_pixel(read, kRight);
    CHECK(read.pixels[3] == 0.5f);
    const Image grey = {1, 1, 1, {0.25f}};
    CHECK(read_image(with_chromaticities(encode_exr(grey), kAcesCg), "t.exr").pixels ==
          std::vector<float>{0.25f, 0.25f, 0.25f});
    const float infinity = std::numeric_limits<float>::infinity();
    const Image bright = {1, 1, 3, {infinity, 1, 1}};
    CHECK(read_image(with_chromaticities(encode_exr(bright), kAcesCg), "t.exr").pixels == bright.pixels);
}

TEST_CASE("PRIMARIES of a Radiance HDR works like an EXR's chromaticities, and zeros are ignored") {
    const auto read = [](const std::string& line, Messages& messages) {
        std::string text = "#?RADIANCE\n" + line + "FORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\n";
        for (const int byte : {64, 128, 32, 129}) text += static_cast<char>(byte); // (.5, 1, .25)
        return read_image(std::as_bytes(std::span(text)), "t.hdr", messages);
    };
    Messages messages;
    CHECK(read("", messages).pixels == std::vector<float>{0.5f, 1, 0.25f});
    CHECK(read("PRIMARIES=0 0 0 0 0 0 0 0\n", messages).pixels == std::vector<float>{0.5f, 1, 0.25f});
    CHECK(read("PRIMARIES=0.64 0.33 0.30 0.60 0.15 0.06 0.3127 0.3290\n", messages).pixels ==
          std::vector<float>{0.5f, 1, 0.25f});
    CHECK(messages.all().empty());
    // P3's green is outside of Rec. 709.
    check_pixel(read("PRIMARIES= 0.680 0.320 0.265 0.690 0.150 0.060 0.3127 0.3290\r\n", messages),
                {0.38753, 1.02103, 0.18612});
    CHECK(messages.all().empty());
    for (const char* line : {"PRIMARIES=0.64 0.33 x\n", "PRIMARIES=\n", "PRIMARIES=0.6 0.3 0.6 0.3 0.1 0 0.3 0.3\n"}) {
        CAPTURE(line);
        Messages warnings;
        CHECK(read(line, warnings).pixels == std::vector<float>{0.5f, 1, 0.25f});
        CHECK(warnings.all().size() == (std::string(line) == "PRIMARIES=\n" ? 0 : 1));
    }
}

TEST_CASE("chromaticities that are degenerate or of another type are left out with a warning") {
    const std::vector<std::byte> plain = encode_exr(kPicture);
    for (const auto& bytes : {with_chromaticities(plain, {}), with_chromaticities(plain, kAcesCg, "string")}) {
        Messages messages;
        CHECK(read_image(bytes, "t.exr", messages).pixels == kPicture.pixels);
        REQUIRE(messages.all().size() == 1);
        CHECK(messages.all()[0].is_warning);
        CHECK(messages.all()[0].text.find("t.exr: the chromaticities") == 0);
    }
}

TEST_CASE("an EXR's chromaticities convert textures of colours, but not of data") {
    const std::vector<std::byte> bytes = with_chromaticities(encode_exr(kPicture), kAcesCg);
    const fs::path folder = test::scratch_folder();
    const FileAccess access(folder / "a.obj", {});
    Messages messages;
    TextureLoader loader(access, messages);
    Scene scene;
    scene.materials.resize(1);
    scene.materials[0].base_color_texture.image = loader.add_bytes("colour", bytes);
    scene.materials[0].emission_texture.image = loader.add_bytes("emission", bytes);
    scene.materials[0].normal_texture.image = loader.add_bytes("normal", bytes);
    loader.load_into(scene);
    REQUIRE(scene.images.size() == 3);
    check_pixel(scene.images[0].rgba_float, kRight);
    check_pixel(scene.images[1].rgba_float, kRight);
    CHECK(scene.images[2].rgba_float.pixels[0] == kPicture.pixels[0]);
}

} // namespace color_primaries_test
