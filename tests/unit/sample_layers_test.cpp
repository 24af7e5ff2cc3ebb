// Ids, coverage and moments of the layers that take something of every sample.

#include "render/sample_layers/sample_layers.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <string>

#include <doctest/doctest.h>

#include "render/sample_layers/matte_names.h"
#include "render/sample_layers/matte_target.h"
#include "render/sample_layers/variance_target.h"

using namespace pertev;

namespace {

PixelMatte no_mattes() {
    PixelMatte pixel;
    for (uint32_t k = 0; k < kMatteIds; ++k) pixel.ids[k] = pixel.samples[k] = kNoMatte;
    return pixel;
}

bool same_mattes(const PixelMatte& a, const PixelMatte& b) { return std::memcmp(&a, &b, sizeof a) == 0; }

/// Returns the variance of the mean of these samples.
double variance_of(std::initializer_list<float> samples) {
    Moments sum;
    for (const float x : samples) sum = sum + moments_of(x);
    return variance_of_mean(sum, samples.size());
}

} // namespace

TEST_CASE("ids of names are MurmurHash3, and no id is a float that files could "
          "change") {
    CHECK(murmur_hash3("") == 0);
    CHECK(murmur_hash3("hello") == 0x248bfa47);
    CHECK(murmur_hash3("hello, world") == 0x149bbb7f);
    CHECK(murmur_hash3("The quick brown fox jumps over the lazy dog") == 0x2e4ff723);
    CHECK(matte_id("hello") == 0x248bfa47);
    CHECK(matte_id("") == 1u << 23); // zero becomes the least normal number
    uint32_t changed = 0;
    for (uint32_t i = 0; i < 3000; ++i) {
        const std::string name = "thing " + std::to_string(i);
        REQUIRE(std::isnormal(std::bit_cast<float>(matte_id(name))));
        changed += matte_id(name) != murmur_hash3(name) ? 1 : 0;
    }
    CHECK(changed > 5); // two of 256 exponents
    CHECK(changed < 60);
}

TEST_CASE("things without a name get one by their number, and things of one "
          "name share an id") {
    Scene scene;
    scene.instances.resize(3);
    scene.instances[0].name = scene.instances[2].name = "ball";
    scene.materials.resize(1);
    const MatteNames names(scene);
    CHECK(names.objects == std::vector<std::string>{"ball", "instance 1", "ball"});
    CHECK(names.materials == std::vector<std::string>{"material 0"});
    CHECK(names.object_ids[0] == names.object_ids[2]);
    CHECK(names.object_ids[1] == matte_id("instance 1"));
}

TEST_CASE("metadata of mattes list the names that are shown, by the type's key") {
    const std::vector<std::string> names = {"b\"", "a", "c", "a"};
    const std::vector<uint32_t> shown = [&] {
        std::vector<uint32_t> ids = {matte_id("a"), matte_id("b\"")};
        std::ranges::sort(ids);
        return ids;
    }();
    const auto entries = matte_metadata("CryptoObject", names, shown);
    REQUIRE(entries.size() == 4);
    CHECK(entries[0].first == "cryptomatte/3ae39a5/name");
    CHECK(entries[0].second == "CryptoObject");
    CHECK(entries[3].second.starts_with("{\"a\":\"3c2569b2\",\"b\\\"\":\""));
    CHECK(entries[3].second.find("\"c\"") == std::string::npos);
}

TEST_CASE("a pixel with more names than fit keeps the same ones in any order "
          "and division of its samples") {
    std::vector<uint32_t> ids;
    for (uint32_t i = 0; i < 60; ++i) ids.push_back(1 + (i * 7 + i / 5) % 23);
    PixelMatte whole = no_mattes(), parts[3] = {no_mattes(), no_mattes(), no_mattes()};
    for (const uint32_t id : ids) whole.take(id, 1);
    for (std::size_t i = 0; i < ids.size(); ++i) parts[i * 5 % 3].take(ids[ids.size() - 1 - i], 1);
    CHECK(whole.ids[kMatteIds - 1] != kNoMatte);
    for (const auto& order : {std::array{0, 1, 2}, {2, 0, 1}, {1, 2, 0}}) {
        PixelMatte sum = no_mattes();
        for (const int part : order) AddMattes{&parts[part], &sum}(0);
        CHECK(same_mattes(sum, whole));
    }
    for (uint32_t k = 0; k < kMatteIds; ++k)
        CHECK(whole.samples[k] == static_cast<uint32_t>(std::ranges::count(ids, whole.ids[k])));
}

TEST_CASE("the variance of the mean is exact: none of equal samples, and that "
          "of numbers known by hand") {
    CHECK(variance_of({0.3f, 0.3f, 0.3f}) == 0);
    CHECK(variance_of({1e-9f, 1e-9f, 1e-9f, 1e-9f, 1e-9f}) == 0);
    CHECK(variance_of({1e12f, 1e12f, 1e12f}) == 0); // squares beyond 2^40
    CHECK(variance_of({5}) == 0);
    CHECK(variance_of({}) == 0);
    CHECK(variance_of({1, 3}) == 1); // samples have 2, their mean half of that
    CHECK(variance_of({-1, 1}) == 1);
    CHECK(variance_of({0, 0, 0, 4}) == 1);
    CHECK(variance_of({1e-4f, 3e-4f}) == doctest::Approx(1e-8).epsilon(1e-6));
    CHECK(variance_of({0, 0x1p40f}) == 0x1p78);
    CHECK(variance_of({0x1p20f, 1}) == doctest::Approx(std::pow(0x1p20 - 1, 2) / 4)); // one square in each unit
    CHECK(variance_of({1, 1 + 0x1p-23f}) == 0x1p-48);
}

TEST_CASE("sums of the most and largest samples do not overflow") {
    Moments sum = moments_of(0x1p40f);
    for (int i = 0; i < 22; ++i) sum = sum + sum; // 2^22 samples of both signs
    Moments negative = moments_of(-0x1p40f);
    for (int i = 0; i < 22; ++i) negative = negative + negative;
    CHECK(variance_of_mean(sum, 1u << 22) == 0);
    const Moments both = sum + negative;
    CHECK(variance_of_mean(both, 1u << 23) == doctest::Approx(0x1p80 / 0x1p23));
    Moments below = moments_of(std::nextafter(0x1p20f, 0.0f)); // squares just below those of the other unit
    for (int i = 0; i < 22; ++i) below = below + below;
    CHECK(variance_of_mean(below + below, 1u << 23) == 0);
}

TEST_CASE("names of layers and the channels that they take are those of their "
          "targets") {
    Queue queue = Queue::make_cpu();
    uint32_t all = 0;
    for (const std::string& name : sample_layer_names()) {
        const SampleLayerBits bit = sample_layer_named(name).value();
        CAPTURE(name);
        Film film(queue, 5, 3, 0);
        hold_sample_layers(queue, bit, film);
        CHECK(sample_layers_of(film) == bit);
        uint32_t channels = 0;
        for (const FilmLayer& layer : film.layers()) {
            channels += layer.image.channels;
            CHECK(layer.image.width == 5);
            CHECK(layer.image.height == 3);
            CHECK(layer.channels.size() == layer.image.channels);
        }
        CHECK(channels == sample_layer_channels(bit));
        all |= bit;
    }
    CHECK(sample_layer_names(all) == sample_layer_names());
    CHECK_FALSE(sample_layer_named("albedo").has_value());
}
