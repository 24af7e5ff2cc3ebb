// Stages of the reconstruction on a few pixels: weights of neighbours by object, normal, plane, light and variance,
// and the limits of history clamping.

#include <doctest/doctest.h>

#include <vector>

#include "denoise/accumulate_signals.h"
#include "denoise/anti_alias.h"
#include "denoise/clamp_history.h"
#include "denoise/compare_light.h"
#include "denoise/upsample_picture.h"
#include "denoise/wavelet_pass.h"

using namespace pertev;

namespace {

constexpr uint32_t kStageSide = 16, kStageHalf = kStageSide / 2, kStagePixels = kStageSide * kStageSide;
constexpr uint32_t kLeftOfBorder =
    kStageHalf * kStageSide + kStageHalf - 1; // the last pixel of the left half in the middle row

CameraView stage_camera(uint32_t side) {
    Camera camera;
    camera.world_from_camera = look_at({0, 0, 0}, {0, 0, -1}, {0, 1, 0});
    return make_camera_view(camera, side, side);
}

/// A wall of one object that faces the camera at 5 m. Its right half can differ in one property at a time.
const Float4 kWallGuide = pack({{0, 0, 1}, 1, 5, 7});
struct Wall {
    std::vector<Float4> guide = std::vector<Float4>(kStagePixels, kWallGuide);

    void set_right(const Guide& g) {
        for (uint32_t i = 0; i < kStagePixels; ++i) {
            if (i % kStageSide >= kStageHalf) guide[i] = pack(g);
        }
    }
};

const Vec3 kTurned = normalize(Vec3{1, 0, 0.5f});

/// One value on the left and another on the right, with the same variance.
std::vector<Float4> halves(float left, float right, float variance) {
    std::vector<Float4> values;
    for (uint32_t i = 0; i < kStagePixels; ++i)
        values.push_back(with_w(grey(i % kStageSide < kStageHalf ? left : right), variance));
    return values;
}

struct Filtered {
    std::vector<Float4> diffuse, gloss;
};

Filtered filter_once(Wall& wall, std::vector<Float4> diffuse, std::vector<Float4> gloss, int step) {
    Filtered out = {std::vector<Float4>(kStagePixels), std::vector<Float4>(kStagePixels)};
    const WaveletPass pass = {wall.guide.data(),
                              {diffuse.data(), gloss.data()},
                              {out.diffuse.data(), out.gloss.data()},
                              stage_camera(kStageSide),
                              kStageSide,
                              kStageSide,
                              step,
                              8,
                              0.125f,
                              true};
    for (uint32_t i = 0; i < kStagePixels; ++i) pass(i);
    return out;
}

constexpr float kNoisy = 1e4f, kExact = 0; // variances

} // namespace

TEST_CASE("a filter pass mixes light of one surface, but not across edges of object, normal, plane or light") {
    Wall one;
    const auto mixed = [&](Wall& wall, float variance) {
        return filter_once(wall, halves(1, 3, variance), halves(1, 3, variance), 1);
    };
    const Filtered plain = mixed(one, kNoisy);
    CHECK(plain.diffuse[kLeftOfBorder].x ==
          doctest::Approx(1.5).epsilon(0.01)); // a quarter of the tent filter's weight is beyond the edge
    CHECK(plain.gloss[kLeftOfBorder].x > 1.3f);
    CHECK(plain.diffuse[kLeftOfBorder - 2].x == doctest::Approx(1));
    const Filtered exact = mixed(one, kExact);
    CHECK(exact.diffuse[kLeftOfBorder].x == doctest::Approx(1));
    CHECK(exact.gloss[kLeftOfBorder].x == doctest::Approx(1));
    for (const Guide& other : {Guide{{0, 0, 1}, 1, 5, 8}, Guide{kTurned, 1, 5, 7}, Guide{{0, 0, 1}, 1, 8, 7}}) {
        CAPTURE(other.depth);
        CAPTURE(other.object);
        Wall wall;
        wall.set_right(other);
        const Filtered apart = mixed(wall, kNoisy);
        CHECK(apart.diffuse[kLeftOfBorder].x == doctest::Approx(1));
        CHECK(apart.gloss[kLeftOfBorder].x == doctest::Approx(1));
        CHECK(apart.diffuse[kLeftOfBorder + 1].x == doctest::Approx(3));
    }
}

TEST_CASE("a filter pass mixes gloss of similar widths only, and sharp gloss only from nearby pixels") {
    Wall wall;
    wall.set_right({{0, 0, 1}, 0.2f, 5, 7});
    const Filtered apart = filter_once(wall, halves(1, 3, kNoisy), halves(1, 3, kNoisy), 1);
    CHECK(apart.gloss[kLeftOfBorder].x == doctest::Approx(1));
    CHECK(apart.diffuse[kLeftOfBorder].x > 1.3f);
    // Light that varies by a tenth of itself.
    const auto mixed_from = [&](float alpha, int step, float variance = 0.01f) {
        for (Float4& g : wall.guide) g = pack({{0, 0, 1}, alpha, 5, 7});
        return filter_once(wall, halves(1, 1.2f, variance), halves(1, 1.2f, variance), step).gloss[kLeftOfBorder].x;
    };
    CHECK(mixed_from(0.5f, 4) > 1.02f);
    CHECK(mixed_from(0.001f, 4) == doctest::Approx(1).epsilon(1e-3));
    CHECK(mixed_from(0.001f, 1) > 1.005f);
    CHECK(mixed_from(0.001f, 4, kNoisy) > 1.04f); // noise is averaged
}

TEST_CASE("normals separate reliable light, but not noise") {
    Wall wall;
    const float tilt = 0.4f; // 1 - cosine 0.08
    wall.set_right({normalize(Vec3{tilt, 0, 1}), 1, 5, 7});
    const auto mixed = [&](float variance) {
        const std::vector<Float4> light = halves(1, 1.2f, variance);
        return filter_once(wall, light, light, 1).diffuse[kLeftOfBorder].x;
    };
    CHECK(mixed(0.001f) == doctest::Approx(1).epsilon(1e-3));
    CHECK(mixed(kNoisy) > 1.01f);
    CHECK(mixed(kInfinity) > 1.01f);
}

TEST_CASE("variances are filtered by squared weights, and the filter uses their mean around a pixel") {
    Wall wall;
    const Filtered even = filter_once(wall, halves(1, 1, 2), halves(1, 1, 2), 2);
    CHECK(even.diffuse[kLeftOfBorder].w ==
          doctest::Approx(2 * 2.25 / 16)); // the weights are 1, four times 1/2 and four times 1/4, divided by 4
    // A pixel with variance 0 among others with noise.
    std::vector<Float4> light = halves(1, 3, kNoisy);
    light[kLeftOfBorder].w = kExact;
    CHECK(filter_once(wall, light, light, 1).diffuse[kLeftOfBorder].x > 1.3f);
}

TEST_CASE("bright and noisy light beside dark and sure light is kept") {
    Wall wall;
    std::vector<Float4> light = halves(1, 3, 0.25f);
    for (Float4& value : light) {
        if (value.x < 2) value.w = 1e-4f;
    }
    const Filtered passed = filter_once(wall, light, light, 1);
    CHECK(passed.diffuse[kLeftOfBorder].x < 1.2f);
    CHECK(passed.diffuse[kLeftOfBorder + 1].x > 2.9f);
    CHECK(passed.gloss[kLeftOfBorder + 1].x > 2.9f);
}

namespace {

/// Signals of the first frame of a wall whose light is 1 everywhere, but `brightest` at one pixel.
Filtered first_means(uint32_t pixel, float brightest, bool limits) {
    Wall wall;
    std::vector<Float4> light(kStagePixels, Float4{1, 1, 1, 0}), recent(kStagePixels);
    light[pixel] = {brightest, brightest, brightest, 0};
    Filtered means = {std::vector<Float4>(kStagePixels), std::vector<Float4>(kStagePixels)};
    std::vector<Vec2> squares(kStagePixels);
    const CameraView camera = stage_camera(kStageSide);
    AccumulateSignals<false> stage = {};
    stage.signals = {light.data(), light.data()};
    stage.cameras = {camera, camera, kStageSide, kStageSide};
    stage.now = {wall.guide.data(), means.diffuse.data(), means.gloss.data(), squares.data(), recent.data(), nullptr};
    stage.longest = 32;
    stage.clamp_fireflies = limits;
    stage.has_gloss = true;
    for (uint32_t i = 0; i < kStagePixels; ++i) stage(i);
    return means;
}

} // namespace

TEST_CASE("firefly clamping limits a sample to 64 times its brightest neighbour") {
    for (const uint32_t pixel : {kLeftOfBorder, 0u, kStagePixels - 1}) { // at the centre and in corners
        CAPTURE(pixel);
        const Filtered limited = first_means(pixel, 1000, true);
        CHECK(limited.diffuse[pixel].x == doctest::Approx(64));
        CHECK(limited.gloss[pixel].y == doctest::Approx(64));
        CHECK(limited.diffuse[pixel == 0 ? 1 : pixel - 1].x == doctest::Approx(1));
        CHECK(first_means(pixel, 60, true).diffuse[pixel].x == doctest::Approx(60));
        CHECK(first_means(pixel, 1000, false).diffuse[pixel].x == doctest::Approx(1000));
    }
}

namespace {

struct Held {
    Float4 diffuse, gloss, diffuse_out, gloss_out; // values of the tested pixel
};

/// A long-term mean of 3 at one pixel over `frames`, with the recent means `left` and `right`. Single frames have the
/// standard deviation `deviation`.
Held hold(Wall& wall, float left, float right, float deviation, float frames, bool limits) {
    std::vector<Float4> diffuse(kStagePixels, Float4{1, 1, 1, frames}), gloss = diffuse,
                                                                        recent = halves(left, right, 0);
    for (Float4& r : recent) r.w = r.x;
    std::vector<Vec2> squares(kStagePixels, Vec2{1, 1});
    diffuse[kLeftOfBorder] = gloss[kLeftOfBorder] = {3, 3, 3, frames};
    squares[kLeftOfBorder] = {9 + deviation * deviation, 9 + deviation * deviation};
    std::vector<Float4> diffuse_out(kStagePixels), gloss_out(kStagePixels);
    const ClampHistory stage = {
        {wall.guide.data(), diffuse.data(), gloss.data(), squares.data(), recent.data(), nullptr},
        {diffuse_out.data(), gloss_out.data()},
        kStageSide,
        kStageSide,
        limits,
        true};
    for (uint32_t i = 0; i < kStagePixels; ++i) stage(i);
    return {diffuse[kLeftOfBorder], gloss[kLeftOfBorder], diffuse_out[kLeftOfBorder], gloss_out[kLeftOfBorder]};
}

} // namespace

TEST_CASE("history clamping limits long means to the range of recent ones of the same surface") {
    Wall wall;
    const Held held = hold(wall, 1, 1, 0, 32, true);
    CHECK(held.diffuse.x == doctest::Approx(1));
    CHECK(held.gloss.x == doctest::Approx(1));
    CHECK(held.diffuse_out.x == held.diffuse.x);
    CHECK(hold(wall, 1, 1, 0, 32, false).diffuse.x == 3);
    CHECK(hold(wall, 1, 1, 0, 3, true).diffuse.x == 3); // the history is too short to be limited
    CHECK(hold(wall, 1, 1, 2, 32, true).diffuse.x == doctest::Approx(2).epsilon(0.01));
    CHECK(hold(wall, 1, 1, 2, 32, true).gloss.x == doctest::Approx(2).epsilon(0.01));
    CHECK(hold(wall, 1, 9, 0, 32, true).diffuse.x == 3); // neighbours differ by more than that
    for (const Guide& other : {Guide{{0, 0, 1}, 1, 5, 8}, Guide{kTurned, 1, 5, 7}}) {
        Wall apart;
        apart.set_right(other);
        CHECK(hold(apart, 1, 9, 0, 32, true).diffuse.x == doctest::Approx(1));
    }
}

TEST_CASE("variance is temporal, or spatial where the history is short") {
    Wall wall;
    CHECK(hold(wall, 3, 3, 2, 32, false).diffuse_out.w == doctest::Approx(4 * 4.0 / 32));
    CHECK(hold(wall, 3, 3, 2, 32, false).gloss_out.w == doctest::Approx(4 * 4.0 / 32));
    // Five of thirteen neighbours in a chessboard pattern are to the right of the border: 8 have the value 0, 5 the
    // value 2.
    const float spread = hold(wall, 0, 2, 0, 1, false).diffuse_out.w;
    CHECK(spread > 4 * 0.8f);
    CHECK(spread < 4 * 1.01f);
    CHECK(hold(wall, 0, 2, 0, 2, false).diffuse_out.w == doctest::Approx(spread / 2));
    Wall lonely;
    lonely.guide[kLeftOfBorder] = pack({{0, 0, 1}, 1, 5, 9});
    CHECK(hold(lonely, 0, 2, 0, 1, false).diffuse_out.w > 1e6f); // unknown
}

namespace {

/// Returns the tested pixel of a picture with `own` at the centre of `around`, and a history of `old` to the left of
/// column kStageHalf + 2. The light has been steady for `frames` frames, of which 8 are enough, and the pixels were at
/// rest for `at_rest` frames before.
float shown_after(float own, float around, float old, bool is_near_moving, float frames = 7, uint32_t at_rest = 6) {
    std::vector<Float4> picture(kStagePixels, Float4{around, 0, 0, 5}), before(kStagePixels, Float4{0, 0, 0, 0}),
        shown(kStagePixels);
    std::vector<Vec2> was_at;
    for (uint32_t i = 0; i < kStagePixels; ++i) {
        was_at.push_back({static_cast<float>(i % kStageSide) + 0.5f, static_cast<float>(i / kStageSide) + 0.5f});
        before[i].w = ShownMemory{at_rest, 0}.pack();
        if (i % kStageSide < kStageHalf + 2) before[i].x = old;
    }
    picture[kLeftOfBorder].x = own;
    if (is_near_moving) { // the pixel to the right is nearer and came from farther right
        picture[kLeftOfBorder + 1].w = 2;
        was_at[kLeftOfBorder + 1].x += 6;
    }
    const std::vector<Float4> means(kStagePixels, Float4{0, 0, 0, frames}), guide(kStagePixels), dark(kStagePixels);
    const AntiAlias stage = {picture.data(), dark.data(),  was_at.data(),
                             before.data(),  shown.data(), kStageSide,
                             kStageSide,     true,         {means.data(), guide.data(), kStageSide, kStageSide, 8}};
    for (uint32_t i = 0; i < kStagePixels; ++i) stage(i);
    return shown[kLeftOfBorder].x;
}

} // namespace

TEST_CASE(
    "displayed colours are temporal means clamped to their neighbourhood, and edges move with the nearest surface") {
    // Eight values of .5 and one of .9 have the mean .5444 and the deviation .1257.
    CHECK(shown_after(0.9f, 0.5f, 0.5f, false) == doctest::Approx(0.5 + 0.1 * 0.4));
    CHECK(shown_after(0.9f, 0.5f, 0.1f, false) == doctest::Approx(0.4187 + 0.1 * (0.9 - 0.4187)).epsilon(0.001));
    CHECK(shown_after(0.5f, 0.5f, 0.9f, false) == doctest::Approx(0.5));
    // Under steady light the history is right, unless the surface moves.
    CHECK(shown_after(0.5f, 0.5f, 0.9f, false, 8, 7) == doctest::Approx(0.9 + 0.1 * (0.5 - 0.9)));
    CHECK(shown_after(0.9f, 0.5f, 0.5f, true, 8, 7) == shown_after(0.9f, 0.5f, 0.5f, true));
    // Where light has changed, a long rest does not help.
    CHECK(shown_after(0.5f, 0.5f, 0.9f, false, 3, 7) == doctest::Approx(0.5));
    // The history where the nearest pixel came from is black. It has moved by six pixels, so old colours are clamped
    // to half a deviation, and current ones have a weight of 0.4.
    CHECK(shown_after(0.9f, 0.5f, 0.5f, true) == doctest::Approx(0.4816 + 0.4 * (0.9 - 0.4816)).epsilon(0.001));
}

namespace {

/// Returns the tested pixel, on a line of `own` as thin as a pixel through a picture of 0.5, whose history of `old` has
/// `frames` frames.
float shown_on_line(float own, float old, float frames, Contact contact) {
    std::vector<Float4> picture(kStagePixels, Float4{0.5f, 0, 0, 5}), before(kStagePixels, Float4{0.5f, 0, 0, 0}),
        shown(kStagePixels);
    std::vector<Vec2> was_at;
    for (uint32_t i = 0; i < kStagePixels; ++i) {
        was_at.push_back({static_cast<float>(i % kStageSide) + 0.5f, static_cast<float>(i / kStageSide) + 0.5f});
        if (i / kStageSide == kLeftOfBorder / kStageSide) picture[i].x = own, before[i].x = old;
    }
    const std::vector<Float4> means(kStagePixels, Float4{0, 0, 0, frames}),
        guide(kStagePixels, pack({{0, 0, 1}, 1, 5, object_with(7, contact)})), dark(kStagePixels);
    const AntiAlias stage = {picture.data(), dark.data(),  was_at.data(),
                             before.data(),  shown.data(), kStageSide,
                             kStageSide,     true,         {means.data(), guide.data(), kStageSide, kStageSide, 99}};
    for (uint32_t i = 0; i < kStagePixels; ++i) stage(i);
    return shown[kLeftOfBorder].x;
}

/// Returns a shown pixel whose history of 0.25 has seen the emission `seen`, after `frames` frames in motion that hit
/// nothing but darkness. `may_change` is that of SteadyLight.
Float4 shown_of_emitter(float seen, uint32_t frames, bool may_change) {
    const std::vector<Float4> picture(kStagePixels, Float4{0, 0, 0, 5}), means(kStagePixels), guide(kStagePixels);
    std::vector<Float4> before(kStagePixels, Float4{0.25f, 0.125f, 0, ShownMemory{0, seen}.pack()}), shown = before;
    std::vector<Vec2> was_at;
    for (uint32_t i = 0; i < kStagePixels; ++i) {
        was_at.push_back({static_cast<float>(i % kStageSide) + 1.5f, static_cast<float>(i / kStageSide) + 0.5f});
    }
    for (uint32_t k = 0; k < frames; ++k) {
        const AntiAlias stage = {
            picture.data(), picture.data(), was_at.data(),
            before.data(),  shown.data(),   kStageSide,
            kStageSide,     true,           {means.data(), guide.data(), kStageSide, kStageSide, 8, may_change}};
        for (uint32_t i = 0; i < kStagePixels; ++i) stage(i);
        std::swap(before, shown);
    }
    return before[kLeftOfBorder];
}

} // namespace

TEST_CASE("in a scene at rest, the light of an emitter that frames miss stays as long as it may be there") {
    CHECK(shown_of_emitter(2, 1, true).x == 0); // clamped to the darkness around
    const Float4 kept = shown_of_emitter(2, 1, false);
    CHECK(kept.x == doctest::Approx(0.8 * 0.25)); // a pixel of motion: the frame has a weight of 0.2
    CHECK(kept.y == doctest::Approx(0.8 * 0.125));
    CHECK(ShownMemory::unpack(kept.w).emitted == doctest::Approx(0.9 * 2).epsilon(0.01));
    CHECK(shown_of_emitter(2, 4, false).x == doctest::Approx(0.4096 * 0.25));
    // No mean is brighter than what was seen.
    CHECK(shown_of_emitter(0.1f, 1, false).x == doctest::Approx(0.8 * 0.9 * 0.1).epsilon(0.01));
    CHECK(ShownMemory::unpack(ShownMemory{123, 0.5f}.pack()).frames_at_rest == 123);
    CHECK(ShownMemory::unpack(ShownMemory{70000, 0.5f}.pack()).emitted == 0.5f);
}

TEST_CASE("light is steady after enough frames, or at once where the scene is that of the frame before") {
    const std::vector<Float4> means(kStagePixels, Float4{0, 0, 0, 3}), guide(kStagePixels);
    SteadyLight steady = {means.data(), guide.data(), kStageSide, kStageSide, 8};
    CHECK_FALSE(steady.is_around({1, 1}, kStageSide, kStageSide));
    steady.may_change = false;
    CHECK(steady.is_around({1, 1}, kStageSide, kStageSide));
}

TEST_CASE("the signal of a black channel is that of the others, and that of a black surface is unknown") {
    const Float4 red = diffuse_signal({0.25f, 0.5f, 0.25f}, {0.5f, 0, 0.125f});
    CHECK(red.x == 0.5f);
    CHECK(red.y == 1.25f); // the mean
    CHECK(red.z == 2);
    CHECK(red.w == 0);
    CHECK(diffuse_signal({0.25f, 0.5f, 0.25f}, {0, 0, 0}).w == kUnknownSignal);
}

TEST_CASE("where contacts are known, thin gaps do not fade, and no shown mean is longer than that of its light") {
    for (const Contact contact : {Contact::Open, Contact::Covered}) {
        CHECK(shown_on_line(0.1f, 0.1f, 7, contact) == doctest::Approx(0.1));
        CHECK(shown_on_line(0.1f, 0.3f, 1, contact) == doctest::Approx(0.2));
        CHECK(shown_on_line(0.1f, 0.3f, 30, contact) == doctest::Approx(0.28));
    }
    // Three values of 0.1 and six of 0.5 have the mean 0.3667 and the deviation 0.1886.
    CHECK(shown_on_line(0.1f, 0.1f, 7, Contact::Unknown) == doctest::Approx(0.1703).epsilon(0.001));
    CHECK(shown_on_line(0.1f, 0.3f, 1, Contact::Unknown) == doctest::Approx(0.28));
}

TEST_CASE("objects differ from frame to frame by instance and by contact, as far as both are known") {
    const auto of = [](Contact contact, uint32_t instance = 7) { return object_with(instance, contact); };
    CHECK(instance_of(of(Contact::Covered)) == 7);
    CHECK(object_with(kNoHit, Contact::Covered) == kNoHit);
    CHECK(may_be_same(of(Contact::Open), of(Contact::Open)));
    CHECK(may_be_same(of(Contact::Open), of(Contact::Unknown)));
    CHECK(may_be_same(of(Contact::Unknown), of(Contact::Covered)));
    CHECK_FALSE(may_be_same(of(Contact::Open), of(Contact::Covered)));
    CHECK_FALSE(may_be_same(of(Contact::Open), of(Contact::Open, 8)));
    CHECK_FALSE(may_be_same(of(Contact::Unknown), kNoHit));
    CHECK(differ_in_contact(of(Contact::Open), of(Contact::Covered, 8)));
    CHECK_FALSE(differ_in_contact(of(Contact::Unknown), kNoHit));
}

namespace {

/// Returns the light of the tested pixel after upsampling by two. The coarse picture has 1 on the left and 3 on the
/// right, and shows `right` there. The fine pixel is just left of the border.
float enlarged(const Guide& right, uint32_t fine_object = 7) {
    constexpr uint32_t kCoarse = kStageSide / 2;
    std::vector<Float4> guide, diffuse;
    for (uint32_t i = 0; i < kCoarse * kCoarse; ++i) {
        const bool is_left = i % kCoarse < kCoarse / 2;
        guide.push_back(is_left ? pack({{0, 0, 1}, 1, 5, 7}) : pack(right));
        diffuse.push_back(with_w(grey(is_left ? 1.0f : 3.0f), 0));
    }
    std::vector<Float4> light(kStagePixels, Float4{0, 0, 0, 1}), black(kStagePixels, Float4{0, 0, 0, 0}),
        place(kStagePixels, Float4{float_of(fine_object), 0, 0, 0}), normal(kStagePixels, Float4{0, 0, 1, 5}),
        white(kStagePixels, Float4{1, 1, 1, 1}), picture(kStagePixels), met(kStagePixels, Float4{0, 0, 0, 1});
    NoisyFrameView features;
    features.light = light.data(), features.emission = met.data(), features.hit = place.data();
    features.normal = normal.data(), features.albedo = white.data(), features.gloss = black.data();
    const UpsamplePicture stage = {
        features,
        {{diffuse.data(), nullptr}, guide.data(), stage_camera(kCoarse), kCoarse, kCoarse, false},
        stage_camera(kStageSide),
        kStageSide,
        kStageSide,
        {},
        {},
        {},
        nullptr,
        picture.data(),
        false};
    stage(kLeftOfBorder);
    return light_of_shown(rgb_of(picture[kLeftOfBorder])).g;
}

} // namespace

TEST_CASE("upsampling takes light from coarse pixels of the same object, normal and plane") {
    CHECK(enlarged({{0, 0, 1}, 1, 5, 7}) > 1.2f); // both halves are one surface
    CHECK(enlarged({{0, 0, 1}, 1, 5, 8}) == doctest::Approx(1));
    CHECK(enlarged({kTurned, 1, 5, 7}) < 1.01f);
    CHECK(enlarged({{0, 0, 1}, 1, 9, 7}) < 1.05f);
    CHECK(enlarged({{0, 0, 1}, 1, 5, 8}, 9) > 1.2f); // no coarse pixel shows the surface, so all are used
}

TEST_CASE("temporal gradients exist where both pictures show the same surface and spread over that surface only") {
    std::vector<Float4> light(4, Float4{2, 2, 2, 1}), black(4, Float4{0, 0, 0, 0}), white(4, Float4{1, 1, 1, 1}),
        met(4, Float4{0, 0, 0, 1}), place(4, Float4{float_of(7), 0, 0, 0}), normal(4, Float4{0, 0, 1, 5});
    std::vector<Float4> other_place = place, other_normal = normal, guide(4), was(4), is(4);
    other_place[1].x = float_of(8);
    other_normal[2].w = 9;
    NoisyFrameView after;
    after.light = light.data(), after.emission = met.data(), after.hit = place.data();
    after.normal = normal.data(), after.albedo = white.data(), after.gloss = black.data();
    NoisyFrameView before = after;
    before.hit = other_place.data(), before.normal = other_normal.data();
    const CompareLight compare = {before, after, guide.data(), was.data(), is.data()};
    for (uint32_t i = 0; i < 4; ++i) compare(i);
    CHECK(instance_of(object_of(guide[0])) == 7);
    CHECK(object_of(guide[1]) == kNoHit);
    CHECK(object_of(guide[2]) == kNoHit);
    CHECK(is[0].x == 2);

    for (const Guide& right :
         {Guide{{0, 0, 1}, 1, 5, 7}, Guide{{0, 0, 1}, 1, 5, 8}, Guide{kTurned, 1, 5, 7}, Guide{{0, 0, 1}, 1, 8, 7}}) {
        Wall wall;
        wall.set_right(right);
        const std::vector<Float4> from = halves(1, 3, 0);
        std::vector<Float4> was_out(kStagePixels), is_out(kStagePixels);
        const SpreadLight spread = {wall.guide.data(), from.data(), from.data(), was_out.data(),
                                    is_out.data(),     kStageSide,  kStageSide,  1};
        for (uint32_t i = 0; i < kStagePixels; ++i) spread(i);
        const bool is_one = right.object == 7 && right.depth == 5 && right.normal.z == 1;
        CHECK(is_out[kLeftOfBorder].x == doctest::Approx(is_one ? 1.5 : 1.0));
        CHECK(was_out[kLeftOfBorder].x == is_out[kLeftOfBorder].x);
    }
}
