// A pass of the filter of single pictures moves light between pixels and neither adds nor takes any.

#include <doctest/doctest.h>

#include <vector>

#include "denoise/even_pass.h"
#include "tests/support/random.h"

using namespace pertev;
using namespace pertev::test;

namespace {

constexpr uint32_t kEvenSide = 24, kEvenPixels = kEvenSide * kEvenSide;

struct EvenSignals {
    std::vector<Float4> diffuse = std::vector<Float4>(kEvenPixels), gloss = diffuse;
};

/// Filters these signals once on a bumpy surface, or on a flat one.
EvenSignals filter_evenly(EvenSignals in, bool is_flat, int step) {
    Random random(3);
    std::vector<Float4> guide;
    for (uint32_t i = 0; i < kEvenPixels; ++i) {
        const Vec3 bump = {random.unit() - 0.5f, random.unit() - 0.5f, 4};
        const float alpha = 0.05f + 0.1f * random.unit(), depth = 5 + 0.02f * random.unit();
        guide.push_back(is_flat ? pack({{0, 0, 1}, 1, 5, 7}) : pack({normalize(bump), alpha, depth, 7}));
    }
    EvenSignals out;
    Camera camera;
    camera.world_from_camera = look_at({0, 0, 0}, {0, 0, -1}, {0, 1, 0});
    const EvenPass pass = {.guide = guide.data(),
                           .from = {in.diffuse.data(), in.gloss.data()},
                           .to = {out.diffuse.data(), out.gloss.data()},
                           .camera = make_camera_view(camera, kEvenSide, kEvenSide),
                           .width = kEvenSide,
                           .height = kEvenSide,
                           .step = step,
                           .tolerance = 4,
                           .has_gloss = true};
    for (uint32_t i = 0; i < kEvenPixels; ++i) pass(i);
    return out;
}

double light_of(const std::vector<Float4>& signal) {
    double sum = 0;
    for (const Float4& value : signal) sum += static_cast<double>(value.x);
    return sum;
}

double squares_of(const std::vector<Float4>& signal) {
    double sum = 0;
    for (const Float4& value : signal) sum += static_cast<double>(square(value.x));
    return sum;
}

} // namespace

TEST_CASE("a pass keeps the light of few bright samples, whose variance is that of their pixels alone") {
    EvenSignals in;
    Random random(1);
    for (uint32_t i = 0; i < kEvenPixels; ++i) {
        const float light = random.unit() < 0.05f ? 20 * random.unit() : 0.1f;
        in.diffuse[i] = {light, light, light, square(light)};
        in.gloss[i] = {light, light, light, 0.3f * square(light)};
    }
    for (const int step : {1, 2, 8}) {
        const EvenSignals out = filter_evenly(in, false, step);
        CHECK(light_of(out.diffuse) == doctest::Approx(light_of(in.diffuse)).epsilon(1e-5));
        CHECK(light_of(out.gloss) == doctest::Approx(light_of(in.gloss)).epsilon(1e-5));
        CHECK(squares_of(out.diffuse) < 0.8 * squares_of(in.diffuse));
    }
}

TEST_CASE("a pass over even noise is the tent, and an unknown pixel takes its neighbours") {
    EvenSignals in;
    const uint32_t middle = kEvenSide / 2 * kEvenSide + kEvenSide / 2;
    for (uint32_t i = 0; i < kEvenPixels; ++i) in.diffuse[i] = in.gloss[i] = {1, 1, 1, 1};
    in.diffuse[middle - 3 * kEvenSide].w = kUnknownSignal;
    in.diffuse[middle - 3 * kEvenSide].x = 9;
    const EvenSignals out = filter_evenly(in, true, 1);
    CHECK(out.diffuse[middle].x == doctest::Approx(1));
    CHECK(out.diffuse[middle].w == doctest::Approx(9.0 / 64)); // (16 + 4 * 4 + 4) / 256
    CHECK(out.diffuse[middle - 3 * kEvenSide].x == doctest::Approx(1));
    CHECK(out.diffuse[middle - 3 * kEvenSide].w > 0);
}
