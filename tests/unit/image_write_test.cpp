#include <doctest/doctest.h>

#include <cmath>

#include "base/error.h"
#include "base/read_file.h"
#include "image/picture_hash.h"
#include "image/read_image.h"
#include "image/write_image.h"
#include "tests/support/options.h"
#include "tests/support/thrown_error.h"

using namespace pertev;

namespace {

Image gradient(uint32_t channels) {
    Image image{31, 17, channels, {}};
    for (uint32_t i = 0; i < 31 * 17 * channels; ++i)
        image.pixels.push_back(
            i % channels == 3 ? 1.0f : static_cast<float>(i) / (31.0f * 17.0f * static_cast<float>(channels)));
    return image;
}

} // namespace

TEST_CASE("the extension determines the format, in upper or lower case") {
    const std::filesystem::path folder = test::scratch_folder();
    const Image image = gradient(3);
    const struct {
        const char* name;
        ImageFormat format;
        float tolerance;
    } files[] = {{"a.exr", ImageFormat::Exr, 0},
                 {"a.HDR", ImageFormat::Hdr, 0.005f},
                 {"a.png", ImageFormat::Png, 0.005f},
                 {"a.Jpg", ImageFormat::Jpeg, 0.05f},
                 {"a.jpeg", ImageFormat::Jpeg, 0.05f}};
    for (const auto& file : files) {
        CAPTURE(file.name);
        write_image(folder / file.name, image);
        CHECK(recognise_image(read_file(folder / file.name)) == file.format);
        const Image back = read_image(folder / file.name);
        REQUIRE(back.pixels.size() == image.pixels.size());
        for (std::size_t i = 0; i < back.pixels.size(); ++i)
            CHECK(std::abs(back.pixels[i] - image.pixels[i]) <= file.tolerance);
    }
}

TEST_CASE("an unknown extension is an error that lists the known ones, and nothing is written") {
    const std::filesystem::path folder = test::scratch_folder();
    for (const char* name : {"a.bmp", "a", "a.exr.txt"}) {
        const auto error = test::thrown_error([&] { write_image(folder / name, gradient(3)); });
        REQUIRE(error);
        CHECK(error->code() == ErrorCode::BadInput);
        for (const char* known : {".exr", ".png", ".jpg", ".jpeg", ".hdr"}) CHECK(test::says(error, known));
    }
    CHECK(std::filesystem::is_empty(folder));
}

TEST_CASE("files that cannot be written are named before rendering") {
    const std::filesystem::path folder = test::scratch_folder();
    const auto refused = [&](const char* name, uint32_t width, uint32_t height) {
        return test::thrown_error([&] { check_image_output(folder / name, width, height); });
    };
    CHECK(!refused("x.jpg", 65500, 65500));
    for (const auto& [width, height] : {std::pair(65501u, 1u), std::pair(1u, 65501u)}) {
        const auto error = refused("x.JPG", width, height);
        REQUIRE(error);
        CHECK(error->code() == ErrorCode::OverLimit);
        CHECK(test::says(error, "x.JPG"));
        CHECK(!refused("x.png", width, height));
    }
    CHECK(refused("x.bmp", 1, 1)->code() == ErrorCode::BadInput);
    CHECK(refused("nowhere/x.png", 1, 1)->code() == ErrorCode::FileWrite);
    CHECK(std::filesystem::is_empty(folder));
}

TEST_CASE("alpha is written to PNG on request") {
    const std::filesystem::path folder = test::scratch_folder();
    const Image half_covered{1, 1, 4, {0.1f, 0.1f, 0.1f, 0.5f}};
    write_image(folder / "t.png", half_covered, {.transparent = true});
    CHECK(read_image(folder / "t.png").channels == 4);
    CHECK(read_image(folder / "t.png").pixels[0] == doctest::Approx(0.2).epsilon(0.02));
    write_image(folder / "o.png", half_covered);
    CHECK(read_image(folder / "o.png").channels == 3);
    CHECK(read_image(folder / "o.png").pixels[0] == doctest::Approx(0.1).epsilon(0.02));
}

TEST_CASE("a picture's hash covers its size and every bit and survives EXR") {
    const std::filesystem::path path = test::scratch_folder() / "h.exr";
    const Image image = gradient(3);
    write_image(path, image);
    CHECK(picture_hash(read_image(path)) == picture_hash(image));

    Image other = image;
    other.pixels[100] = std::nextafter(other.pixels[100], 2.0f);
    CHECK(picture_hash(other) != picture_hash(image));
    other = image;
    std::swap(other.width, other.height);
    CHECK(picture_hash(other) != picture_hash(image));
    CHECK(picture_hash({1, 1, 3, {0, 0, 0}}) != picture_hash({1, 1, 3, {0, -0.0f, 0}}));
    CHECK(picture_hash({2, 1, 1, {3, 4}}) == picture_hash({2, 1, 3, {3, 3, 3, 4, 4, 4}}));
    CHECK(picture_hash({1, 1, 2, {3, 4}}) == picture_hash({1, 1, 4, {3, 3, 3, 4}}));
}
