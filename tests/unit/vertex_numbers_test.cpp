// Random numbers drawn for eight paths at once have the bits of those drawn for single paths.

#include <cstdint>
#include <vector>

#include <doctest/doctest.h>

#include "integrators/path/lane_samples.h"
#include "math/transform.h"
#include "render/pixel_filter.h"
#include "tests/support/random.h"

using namespace pertev;

namespace {

constexpr SamplerKind kNumberedKinds[] = {SamplerKind::Sobol, SamplerKind::Independent};
constexpr uint32_t kWidth = 1920;

PathSettings settings_of(SamplerKind kind, uint32_t seed) { return {.sampler = kind, .seed = seed}; }

/// Eight unrelated paths: the lanes differ in pixel, sample and depth.
PathState path_of(uint32_t lane, uint32_t round) {
    PathState path;
    path.pixel = hash_word(8 * round + lane) % (kWidth * 1080);
    path.sample = lane + 1000 * round;
    path.depth = (lane + round) % 5;
    return path;
}

} // namespace

TEST_CASE("vertex numbers: bits of eight words are reversed like those of one") {
    for (uint32_t round = 0; round < 100; ++round) {
        Words8 words;
        for (uint32_t i = 0; i < kWords; ++i) words[i] = hash_word(8 * round + i);
        const Words8 reversed = reverse_bits(words);
        for (uint32_t i = 0; i < kWords; ++i) {
            uint32_t expected = 0;
            for (uint32_t bit = 0; bit < 32; ++bit) expected |= (words[i] >> bit & 1) << (31 - bit);
            CHECK(reversed[i] == expected);
        }
    }
}

TEST_CASE("vertex numbers: numbers drawn for eight paths at once equal those drawn on demand") {
    const DrawOnDemand one;
    for (const SamplerKind kind : kNumberedKinds) {
        for (const uint32_t seed : {0u, 7u}) {
            const PathSettings settings = settings_of(kind, seed);
            for (uint32_t round = 0; round < 20; ++round) {
                SampleKeyOf<Words8> keys;
                Words8 depths = {};
                for (uint32_t i = 0; i < kWords; ++i) {
                    const PathState path = path_of(i, round);
                    set_lane(keys, i, sample_key(settings, path.pixel, path.sample));
                    depths[i] = path.depth;
                }
                const VertexWords<Words8> words = draw_vertex(kind, keys, depths, true);
                for (uint32_t i = 0; i < kWords; ++i) {
                    const PathState path = path_of(i, round);
                    const DrawnNumbers drawn(words, i);
                    CAPTURE(path.depth);
                    const SampleBits light = drawn.light(settings, path), expected = one.light(settings, path);
                    CHECK(light.x == expected.x);
                    CHECK(light.y == expected.y);
                    CHECK(drawn.direction(settings, path) == one.direction(settings, path));
                    CHECK(drawn.lobe(settings, path) == one.lobe(settings, path));
                    CHECK(drawn.roulette(settings, path) == one.roulette(settings, path));
                }
            }
        }
    }
}

TEST_CASE("rays of eight lanes through any filter and of any camera have the bits of one") {
    const uint32_t pixels[kWords] = {
        0, 1, kWidth - 1, kWidth, 5 * kWidth + 7, 1000000, 1079 * kWidth, 1080 * kWidth - 1};
    const Transform turned = look_at({1, 2, 3}, {-4, 0.5f, 2}, {0, 1, 0});
    test::Random random(3);
    for (const PixelFilter filter :
         {PixelFilter::Box, PixelFilter::Tent, PixelFilter::Gaussian, PixelFilter::BlackmanHarris}) {
        const std::vector<float> table = make_filter_table(filter);
        CameraRays camera =
            make_camera_rays(Camera{}, {filter, default_filter_radius(filter), table.data()}, kWidth, 1080, {0, 0, 0});
        camera.view.world_from_camera = turned;
        for (const Projection projection : {Projection::Perspective, Projection::Orthographic, Projection::Cosine}) {
            camera.view.projection = projection;
            for (uint32_t round = 0; round < 200; ++round) {
                camera.view.aperture_radius = round % 2 == 0 ? 0.0f : 0.1f;
                float in_x[kWords], in_y[kWords], lens_x[kWords], lens_y[kWords], corner_x[kWords], corner_y[kWords];
                for (uint32_t k = 0; k < kWords; ++k) {
                    in_x[k] = random.unit(), in_y[k] = random.below(9) == 0 ? 0x1.fffffep-1f : random.unit();
                    lens_x[k] = random.unit(), lens_y[k] = random.unit();
                    corner_x[k] = camera.corner_of(pixels[k]).x, corner_y[k] = camera.corner_of(pixels[k]).y;
                }
                const auto pair = [](const float* x, const float* y) {
                    return Vec2Of<Floats8>{Floats8::load(x), Floats8::load(y)};
                };
                const RayLineOf<Floats8> all =
                    camera.line(pair(corner_x, corner_y), pair(in_x, in_y), pair(lens_x, lens_y));
                for (uint32_t k = 0; k < kWords; ++k) {
                    const RayLine one =
                        camera.line(Vec2{corner_x[k], corner_y[k]}, Vec2{in_x[k], in_y[k]}, Vec2{lens_x[k], lens_y[k]});
                    CHECK(Vec3{all.origin.x[k], all.origin.y[k], all.origin.z[k]} == one.origin);
                    CHECK(Vec3{all.direction.x[k], all.direction.y[k], all.direction.z[k]} == one.direction);
                }
            }
        }
    }
}

TEST_CASE("vertex numbers: eight paths begun at once equal those begun one by one") {
    CameraRays camera = make_camera_rays(Camera{}, {PixelFilter::Box, 0.5f, nullptr}, kWidth, 1080, {0, 0, 0});
    const MotionKey keys[] = {{{0, 0, 0, 1}, {0, 0, 0}}, {{0, 0.6f, 0, 0.8f}, {3, 0, 0}}};
    for (const SamplerKind kind : kNumberedKinds) {
        for (const float aperture : {0.0f, 0.1f}) {
            for (const bool is_open : {false, true}) {
                const PathSettings settings = settings_of(kind, 3);
                camera.view.aperture_radius = aperture;
                camera.is_open = is_open;
                camera.motion = is_open ? MotionTrack{keys, {0, 0, 0}, 1} : MotionTrack{};
                LaneSamples<Floats8> samples(camera, settings);
                for (const uint32_t count : {8u, 3u, 0u, 1u}) { // lanes without a sample do not change others
                    for (uint32_t i = 0; i < count; ++i) samples.add(path_of(i, count).pixel, path_of(i, count).sample);
                    CHECK(samples.is_full() == (count == kWords));
                    uint32_t i = 0;
                    samples.begin([&](const auto& make) {
                        const PathState path = make();
                        const PathState from = path_of(i++, count);
                        const PathState expected = generate_path(camera, settings, nullptr, from.pixel, from.sample);
                        CHECK(path.pixel == expected.pixel);
                        CHECK(path.sample == expected.sample);
                        CHECK(path.origin == expected.origin);
                        CHECK(path.direction == expected.direction);
                        CHECK(path.time == expected.time);
                        CHECK((is_open ? path.time > 0 && path.time < 1 : path.time == kAtRest));
                    });
                    CHECK(i == count);
                    CHECK(!samples.is_full());
                }
            }
        }
    }
}
