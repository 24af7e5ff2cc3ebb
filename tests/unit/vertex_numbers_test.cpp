// Random numbers that are drawn for eight paths at once are those that each path draws by itself, to the bit.

#include <cstdint>
#include <vector>

#include <doctest/doctest.h>

#include "integrators/path/eight_samples.h"

using namespace pertev;

namespace {

constexpr SamplerKind kKinds[] = {SamplerKind::Sobol, SamplerKind::Independent};
constexpr uint32_t kWidth = 1920;

PathSettings settings_of(SamplerKind kind, uint32_t seed) { return {.sampler = kind, .seed = seed}; }

/// Eight paths that share nothing: every lane another pixel, sample and depth.
PathState path_of(uint32_t lane, uint32_t round) {
    PathState path;
    path.pixel = hash_word(8 * round + lane) % (kWidth * 1080);
    path.sample = lane + 1000 * round;
    path.depth = (lane + round) % 5;
    return path;
}

} // namespace

TEST_CASE("vertex numbers: bits of eight words are reversed as those of one") {
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
    for (const SamplerKind kind : kKinds) {
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

TEST_CASE("vertex numbers: eight paths begun at once equal those begun one by one") {
    CameraRays camera = make_camera_rays(Camera{}, {PixelFilter::Box, 0.5f, nullptr}, kWidth, 1080, {0, 0, 0});
    const MotionKey keys[] = {{{0, 0, 0, 1}, {0, 0, 0}}, {{0, 0.6f, 0, 0.8f}, {3, 0, 0}}};
    for (const SamplerKind kind : kKinds) {
        for (const float aperture : {0.0f, 0.1f}) {
            for (const bool is_open : {false, true}) {
                const PathSettings settings = settings_of(kind, 3);
                camera.view.aperture_radius = aperture;
                camera.is_open = is_open;
                camera.motion = is_open ? MotionTrack{keys, {0, 0, 0}, 1} : MotionTrack{};
                EightSamples samples(camera, settings);
                for (const uint32_t count : {8u, 3u, 0u, 1u}) { // lanes without a sample change no other
                    for (uint32_t i = 0; i < count; ++i) samples.add(path_of(i, count).pixel, path_of(i, count).sample);
                    CHECK(samples.is_full() == (count == kWords));
                    uint32_t i = 0;
                    samples.begin([&](const PathState& path) {
                        const PathState from = path_of(i++, count);
                        const PathState expected = generate_path(camera, settings, from.pixel, from.sample);
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
