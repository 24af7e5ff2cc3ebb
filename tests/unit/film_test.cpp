#include <cmath>
#include <limits>

#include <doctest/doctest.h>

#include "base/parallel_for.h"
#include "render/film.h"
#include "tests/support/meshes.h"

using namespace pertev;

namespace {

constexpr uint32_t kAllAovs = kAovAlbedo | kAovNormal | kAovDepth | kAovPosition | kAovIds;

Image picture_of(Film& film, uint32_t samples, bool transparent) {
    film.set_samples({0, samples});
    return film.picture(transparent);
}

std::vector<FilmLayer> layers_of(Film& film, uint32_t samples) {
    film.set_samples({0, samples});
    return film.layers();
}

} // namespace

TEST_CASE("a film starts black with zeros in every layer, and clear() restores that") {
    Queue queue = Queue::make_cpu();
    Film film(queue, 3, 2, kAllAovs);
    const auto is_empty = [&] {
        for (const float value : picture_of(film, 1, true).pixels) {
            if (value != 0) return false;
        }
        for (const FilmLayer& layer : layers_of(film, 1)) {
            for (const float value : layer.image.pixels) {
                if (value != 0) return false;
            }
        }
        return film.invalid_samples() == 0;
    };
    CHECK(is_empty());
    add_radiance(film.view(), 4, {1, 2, 3});
    add_radiance(film.view(), 4, {1, kInfinity, 3});
    add_channel(film.view(), 4, 3, 1);
    add_channel(film.view(), 4, 5, 0.5f);
    CHECK_FALSE(is_empty());
    film.clear();
    CHECK(is_empty());
}

TEST_CASE("the picture is the mean of the samples of each pixel, rounded once") {
    Queue queue = Queue::make_cpu();
    Film film(queue, 4, 3, 0);
    test::Random random(3);
    double sums[12][3] = {};
    for (int sample = 0; sample < 7; ++sample) {
        for (uint32_t pixel = 0; pixel < 12; ++pixel) {
            const Vec3 value = random.point(0, 4);
            add_radiance(film.view(), pixel, {value.x, value.y, value.z});
            sums[pixel][0] += double(value.x), sums[pixel][1] += double(value.y), sums[pixel][2] += double(value.z);
        }
    }
    const Image picture = picture_of(film, 7, false);
    REQUIRE(picture.width == 4);
    REQUIRE(picture.height == 3);
    REQUIRE(picture.channels == 3);
    for (uint32_t pixel = 0; pixel < 12; ++pixel) {
        for (uint32_t c = 0; c < 3; ++c) {
            CHECK(picture.at(pixel % 4, pixel / 4)[c] ==
                  static_cast<float>(sums[pixel][c] / 7)); // doubles are exact here
        }
    }
}

TEST_CASE("a small sample is not lost in a sum of a million large ones") {
    Queue queue = Queue::make_cpu();
    Film film(queue, 1, 1, 0);
    for (int i = 0; i < 1'000'000; ++i) add_radiance(film.view(), 0, {1000.0f, -1.0f, 0x1p-40f});
    add_radiance(film.view(), 0, {1e-6f, 1'000'000.0f, 0});
    const Image picture = picture_of(film, 1, false);
    CHECK(picture.pixels[0] == 1e9f);
    CHECK(picture.pixels[1] == 0.0f);
    CHECK(picture.pixels[2] == 0x1p-40f * 1e6f);
    for (int i = 0; i < 1'000'000; ++i) add_radiance(film.view(), 0, {-1000.0f, 0, 0});
    CHECK(picture_of(film, 1, false).pixels[0] ==
          doctest::Approx(1e-6).epsilon(1e-7)); // the truncated part is below 2^-64
}

TEST_CASE("a transparent picture's alpha is the share of samples that hit something") {
    Queue queue = Queue::make_cpu();
    Film film(queue, 2, 1, 0);
    for (int sample = 0; sample < 8; ++sample) {
        if (sample < 3) add_channel(film.view(), 0, 3, 1.0f);
        add_radiance(film.view(), 0, {sample < 3 ? 1.0f : 0.0f, 0, 0});
    }
    const Image picture = picture_of(film, 8, true);
    REQUIRE(picture.channels == 4);
    CHECK(picture.at(0, 0)[3] == 0.375f);
    CHECK(picture.at(0, 0)[0] == 0.375f); // colour times coverage
    CHECK(picture.at(1, 0)[3] == 0);
}

TEST_CASE("layers have a fixed order of channels; geometry is a mean over hits, albedo over all samples") {
    Queue queue = Queue::make_cpu();
    Film film(queue, 2, 1, kAovAlbedo | kAovNormal | kAovDepth | kAovPosition);
    const FilmView view = film.view();
    for (int hit = 0; hit < 2; ++hit) { // in pixel 1 two of four samples hit a surface, in pixel 0 none does
        add_channel(view, 1, 3, 1.0f);
        add_channels(view, 1, kFilmColorChannels, {0.5f, 0.25f, 1.0f});
        add_channels(view, 1, kFilmColorChannels + 3, {0, -1, 0});
        add_channel(view, 1, kFilmColorChannels + 6, hit == 0 ? 3.0f : 5.0f);
        add_channels(view, 1, kFilmColorChannels + 7, {10, hit == 0 ? -20.0f : -30.0f, 40});
    }
    const std::vector<FilmLayer> layers = layers_of(film, 4);
    REQUIRE(layers.size() == 4);
    CHECK(layers[0].name == "albedo");
    CHECK(layers[1].name == "normal");
    CHECK(layers[2].name == "depth");
    CHECK(layers[3].name == "position");
    CHECK(layers[0].channels == std::vector<std::string>{"R", "G", "B"});
    CHECK(layers[1].channels == std::vector<std::string>{"X", "Y", "Z"});
    CHECK(layers[2].channels == std::vector<std::string>{"Z"});
    CHECK(layers[3].channels == std::vector<std::string>{"X", "Y", "Z"});
    CHECK(layers[0].image.pixels == std::vector<float>{0, 0, 0, 0.25f, 0.125f, 0.5f});
    CHECK(layers[1].image.pixels == std::vector<float>{0, 0, 0, 0, -1, 0});
    CHECK(layers[2].image.pixels == std::vector<float>{0, 4});
    CHECK(layers[3].image.pixels == std::vector<float>{0, 0, 0, 10, -25, 40});
}

TEST_CASE("a film has only the requested layers, and ids only with kAovIds") {
    Queue queue = Queue::make_cpu();
    const Film plain(queue, 2, 2, 0);
    CHECK(plain.layers().empty());
    CHECK(plain.ids().empty());
    CHECK(plain.view().channels == kFilmColorChannels);
    Film some(queue, 2, 2, kAovDepth | kAovIds);
    REQUIRE(layers_of(some, 1).size() == 1);
    CHECK(layers_of(some, 1)[0].name == "depth");
    CHECK(some.view().channels == kFilmColorChannels + 1);
    some.view().ids[2] = {7, 8, 9};
    REQUIRE(some.ids().size() == 4);
    CHECK(some.ids()[2].primitive == 8);
    CHECK(Film::predicted_bytes(2, 2, kAovDepth | kAovIds) == 4 * (5 * sizeof(FixedSum) + sizeof(PixelIds) + 16) + 8);
    CHECK(queue.allocated_bytes() == Film::predicted_bytes(2, 2, 0) + Film::predicted_bytes(2, 2, kAovDepth | kAovIds));
}

TEST_CASE("a sample with a channel that is not finite or too large adds 0 to all and is counted") {
    Queue queue = Queue::make_cpu();
    Film film(queue, 1, 1, kAovNormal);
    const float nan = std::numeric_limits<float>::quiet_NaN();
    for (const float bad : {nan, kInfinity, -kInfinity, 0x1.000002p40f, -0x1p41f}) {
        add_radiance(film.view(), 0, {bad, 1, 1});
        add_radiance(film.view(), 0, {1, bad, 1});
        add_radiance(film.view(), 0, {1, 1, bad});
        add_channels(film.view(), 0, kFilmColorChannels, {bad, 2, bad});
    }
    CHECK(film.invalid_samples() == 15);
    CHECK(picture_of(film, 1, false).pixels == std::vector<float>{0, 0, 0});
    add_radiance(film.view(), 0, {0x1p40f, -0x1p40f, 0.5f}); // the largest float
    add_channel(film.view(), 0, 3, 1.0f);
    CHECK(film.invalid_samples() == 15);
    CHECK(picture_of(film, 1, false).pixels == std::vector<float>{0x1p40f, -0x1p40f, 0.5f});
    CHECK(layers_of(film, 1)[0].image.pixels ==
          std::vector<float>{0, 10, 0}); // the valid channels of a layer are added
}

TEST_CASE("concurrent additions to a pixel lose nothing") {
    Queue queue = Queue::make_cpu();
    Film film(queue, 1, 1, 0);
    const FilmView view = film.view();
    // The low words overflow at nearly every addition.
    parallel_for(200'000, 100, [&](uint64_t i) { add_radiance(view, 0, {0.75f, i % 2 == 0 ? 0.875f : -0.375f, 1}); });
    const Image picture = picture_of(film, 1, false);
    CHECK(picture.pixels[0] == 150'000.0f);
    CHECK(picture.pixels[1] == 50'000.0f);
    CHECK(picture.pixels[2] == 200'000.0f);
}
