// Fuzz and tinted coats of OpenPBR: the light of fibres and of absorption by the refracted way, alone and in pictures.

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "tests/statistical/bsdf_cases.h"
#include "tests/support/flat_scenes.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"

using namespace pertev;
using namespace pertev::test;

namespace {

constexpr float kFuzzRoughnesses[] = {0.0f, 0.13f, 0.2f, 0.35f, 0.5f, 0.75f, 1.0f};
constexpr float kFuzzCosines[] = {3e-3f, 0.03f, 0.12f, 0.35f, 0.65f, 1.0f};

/// Integrals over directions of what a BSDF scatters: all of it, the share on the side of wo, and the mean cosine.
struct ScatteredLight {
    double all = 0, back = 0, cosine = 0;
};

ScatteredLight light_scattered_by(const Bsdf& bsdf, Vec3 wo) {
    constexpr int kSteps = 300, kTurns = 200;
    ScatteredLight light;
    for (int i = 0; i < kSteps; ++i)
        for (int j = 0; j < kTurns; ++j) {
            const float x = (static_cast<float>(i) + 0.5f) / kSteps, turn = (static_cast<float>(j) + 0.5f) / kTurns;
            const Vec3 wi = direction_at(x * x, turn);
            const double part = 4 * 3.14159265358979 * static_cast<double>(x * bsdf.eval(wo, wi).g) / kSteps / kTurns;
            light.all += part;
            if (wo.x * wi.x + wo.y * wi.y > 0) light.back += part;
            light.cosine += part * static_cast<double>(wi.z);
        }
    light.back /= light.all;
    light.cosine /= light.all;
    return light;
}

struct LeastAndMost {
    double least = 1e9, most = 0, weight = 0;
};

/// Mean weights of what `make` makes of each roughness, over all angles, and the largest weight of a sample.
template <class Make>
LeastAndMost range_of(const Make& make) {
    LeastAndMost range;
    for (const float roughness : kFuzzRoughnesses)
        for (const float cosine : kFuzzCosines) {
            const Bsdf bsdf = make(roughness);
            const auto count = static_cast<uint32_t>(effort(1 << 13, 1 << 18));
            const MeanWeight mean = mean_weight(bsdf, direction_at(cosine), count);
            range.least = std::min(range.least, mean.least());
            range.most = std::max(range.most, mean.largest());
            for (uint32_t i = 0; i < count; ++i) {
                const SamplePoint p = even_point(i, count);
                const BsdfSample s = bsdf.sample(direction_at(cosine), p.lobe, p.u);
                if (!(s.pdf > 0)) continue;
                range.weight = std::max(range.weight, static_cast<double>(s.weight.r + s.weight.g + s.weight.b) / 3);
            }
        }
    return range;
}

/// Length of a way through a coat of thickness 1.
double length_of_way(float cosine, float ior) {
    const double sine = std::sqrt(1 - static_cast<double>(cosine * cosine)) / static_cast<double>(ior);
    return 1 / std::sqrt(1 - sine * sine);
}

/// The mean of a picture of a sheet of `material`, seen along `towards`, under an environment of radiance 1.
Rgb seen_in_furnace(const Material& material, Vec3 towards) {
    Scene scene;
    scene.environment = Environment{};
    test::add(scene, floor_at(0, 4), material);
    RenderSettings settings;
    settings.width = settings.height = 8;
    settings.samples = static_cast<uint32_t>(effort(1024, 1 << 14));
    settings.filter = PixelFilter::Box;
    settings.path.max_depth = 1;
    Camera camera;
    camera.world_from_camera = look_at(towards, {0, 0, 0}, {0, 0.3f, 1});
    camera.projection = Projection::Orthographic;
    camera.ortho_height = 0.1f;
    Queue queue = requested_queue();
    const Image picture = test::render(queue, scene, camera, settings).picture;
    Rgb sum = {};
    for (std::size_t i = 0; i < picture.pixels.size(); i += 3)
        sum += Rgb{picture.pixels[i], picture.pixels[i + 1], picture.pixels[i + 2]};
    return (3.0f / static_cast<float>(picture.pixels.size())) * sum;
}

} // namespace

TEST_CASE("fuzz scatters the light of fibres that were followed one by one") {
    const struct {
        float roughness, cosine;
        double all, back, mean_cosine; // means over a million ways (tools/make_fuzz_table.py, seed 99)
    } followed[] = {{0.2f, 0.05f, 0.4815, 0.5280, 0.1191}, {0.4f, 0.05f, 0.6018, 0.5949, 0.2512},
                    {0.4f, 0.3f, 0.2222, 0.5253, 0.3591},  {0.4f, 0.8f, 0.0136, 0.5135, 0.4294},
                    {0.7f, 0.05f, 0.6591, 0.5861, 0.4495}, {0.7f, 0.3f, 0.4527, 0.5604, 0.5253},
                    {0.7f, 0.8f, 0.1662, 0.5264, 0.5690},  {1.0f, 0.05f, 0.7245, 0.5006, 0.5692},
                    {1.0f, 0.3f, 0.5940, 0.5000, 0.6099},  {1.0f, 0.8f, 0.3915, 0.5016, 0.6257}};
    for (const auto& f : followed) {
        const ScatteredLight light =
            light_scattered_by(make_fuzz(Bsdf{}, grey(1), f.roughness), direction_at(f.cosine));
        INFO("roughness " << f.roughness << ", cosine " << f.cosine << ": " << light.all << " " << light.back << " "
                          << light.cosine);
        CHECK(light.all == doctest::Approx(f.all).epsilon(0.015).scale(0.01));
        CHECK(std::abs(light.back - f.back) < 0.055);
        CHECK(std::abs(light.cosine - f.mean_cosine) < 0.025);
    }
}

TEST_CASE("fuzz gains no light on any base, and no sample has a weight above 1.5, or 2 on a base") {
    const LeastAndMost alone = range_of([](float r) { return make_fuzz(Bsdf{}, grey(1), r); });
    INFO("alone: to " << alone.most << ", weight " << alone.weight);
    CHECK(alone.most < 0.8);
    CHECK(alone.weight < 1.5);
    const LeastAndMost white = range_of([](float r) { return make_fuzz(make_diffuse(grey(1)), grey(1), r); });
    INFO("on white: from " << white.least << " to " << white.most << ", weight " << white.weight);
    CHECK(white.least > 0.85);
    CHECK(white.most < 1.001);
    CHECK(white.weight < 2);
    const LeastAndMost metal =
        range_of([](float r) { return make_fuzz(make_conductor(grey(0), grey(2), 0.1f), grey(1), r); });
    INFO("on a mirror: from " << metal.least << " to " << metal.most << ", weight " << metal.weight);
    CHECK(metal.most < 1.001);
    CHECK(metal.weight < 2);
}

TEST_CASE("a coat tints what is beneath by both refracted ways, by its weight, and not its own reflection") {
    const Rgb color = {0.25f, 0.5f, 1};
    const auto coated = [&](Rgb tint, float weight) {
        return make_coated(make_diffuse(grey(1)), weight, 0.3f, 1.6f, {0, 0, 1}, tint);
    };
    for (uint32_t i = 0; i < 200; ++i) {
        const SamplePoint p = random_point(i, 51), q = random_point(i, 52);
        const Vec3 wo = direction_at(p.u.x, p.u.y), wi = direction_at(-q.u.x, q.u.y);
        const Vec3 up = {wi.x, wi.y, -wi.z};
        const double passes = 0.5 * (length_of_way(wo.z, 1.6f) + length_of_way(up.z, 1.6f));
        const LobeClasses diffuse = only(LobeClass::Diffuse), glossy = only(LobeClass::Glossy);
        const Rgb clear = coated(grey(1), 1).evaluate(wo, up, diffuse).f,
                  dim = coated(color, 1).evaluate(wo, up, diffuse).f;
        CHECK(dim.r == doctest::Approx(static_cast<double>(clear.r) * std::pow(0.25, passes)).epsilon(2e-3));
        CHECK(dim.g == doctest::Approx(static_cast<double>(clear.g) * std::pow(0.5, passes)).epsilon(2e-3));
        CHECK(dim.b == clear.b);
        CHECK(coated(color, 1).evaluate(wo, up, glossy).f == coated(grey(1), 1).evaluate(wo, up, glossy).f);
        // A weight w leaves the share 1 - w bare, and only the rest is tinted.
        const double bare = static_cast<double>(up.z * kInvPi),
                     half = static_cast<double>(coated(color, 0.5f).evaluate(wo, up, diffuse).f.g);
        CHECK(half == doctest::Approx(0.5 * bare + 0.5 * static_cast<double>(dim.g)).epsilon(2e-3));
    }
    // Light crosses the coat of a solid once, and both coats of a thin wall.
    const auto straight = [&](const Bsdf& base, Rgb tint) {
        return make_coated(base, 1, 0.3f, 1.5f, {0, 0, 1}, tint).specular(direction_at(0.6f)).refraction;
    };
    const Bsdf glass = make_dielectric(1.5f, 0, grey(1)),
               pane = make_reflection({.base_color = grey(1), .roughness = 0, .through = 1});
    const double once = 0.5 * length_of_way(0.6f, 1.5f);
    CHECK(straight(glass, color).r ==
          doctest::Approx(static_cast<double>(straight(glass, grey(1)).r) * std::pow(0.25, once)).epsilon(1e-3));
    CHECK(straight(pane, color).g ==
          doctest::Approx(static_cast<double>(straight(pane, grey(1)).g) * std::pow(0.5, 2 * once)).epsilon(1e-3));
    const auto inside = [&](Rgb tint) { // light that glass reflects back inside crosses no coat
        return make_coated(glass, 1, 0.3f, 1.5f, {0, 0, 1}, tint).specular(direction_at(-0.8f)).mirror;
    };
    CHECK(inside(color) == inside(grey(1)));
    CHECK(inside(color).g > 0);
    const Bsdf lacquered[] = {make_coated(glass, 0.8f, 0, 1.5f, {0, 0, 1}, color),
                              make_coated(make_conductor(grey(0), grey(2), 0), 0.8f, 0, 1.5f, {0, 0, 1}, color)};
    for (const Bsdf& smooth : lacquered) { // samples return what specular() does
        const SpecularBranches branches = smooth.specular(direction_at(0.6f));
        const MeanWeight mean = mean_weight(smooth, direction_at(0.6f), 1 << 14);
        CHECK(mean.r == doctest::Approx(branches.mirror.r + branches.refraction.r).epsilon(2e-3));
        CHECK(mean.b == doctest::Approx(branches.mirror.b + branches.refraction.b).epsilon(2e-3));
        CHECK(mean.r < 0.6 * mean.b);
    }
    const auto on_metal = [&](Rgb tint) {
        return range_of([&](float r) {
            return make_coated(make_conductor(grey(0), grey(2), 0.2f), 1, r, 1.5f, {0, 0, 1}, tint);
        });
    };
    CHECK(on_metal(color).weight < 1.001 * on_metal(grey(1)).weight);
}

TEST_CASE("pictures have the fuzz and the coat's colour of their materials") {
    const Vec3 towards = {0, 0.5f, 0.8660254f};
    Material velvet = white(0.2f);
    velvet.fuzz_weight = 0.8f;
    velvet.fuzz_color = {1, 0.5f, 0.25f};
    velvet.fuzz_roughness = 0.9f;
    for (const FuzzModel model : {FuzzModel::Charlie, FuzzModel::Zeltner}) {
        velvet.fuzz_model = model;
        const Rgb strength = 0.8f * velvet.fuzz_color;
        const Bsdf bsdf = model == FuzzModel::Charlie ? make_sheen(make_diffuse(grey(0.2f)), strength, 0.9f)
                                                      : make_fuzz(make_diffuse(grey(0.2f)), strength, 0.9f);
        const MeanWeight expected = mean_weight(bsdf, direction_at(0.5f), 1 << 16);
        const Rgb seen = seen_in_furnace(velvet, towards);
        CAPTURE(static_cast<int>(model));
        CHECK(static_cast<double>(seen.r) == doctest::Approx(expected.r).epsilon(0.01));
        CHECK(static_cast<double>(seen.b) == doctest::Approx(expected.b).epsilon(0.01));
    }
    Material lacquer = white(0.7f);
    lacquer.coat_weight = 0.9f;
    lacquer.coat_roughness = 0.4f;
    lacquer.coat_color = {0.9f, 0.3f, 0.1f};
    const Bsdf bsdf = make_coated(make_diffuse(grey(0.7f)), 0.9f, 0.4f, 1.5f, {0, 0, 1}, lacquer.coat_color);
    const MeanWeight expected = mean_weight(bsdf, direction_at(0.5f), 1 << 16);
    const Rgb seen = seen_in_furnace(lacquer, towards);
    CHECK(static_cast<double>(seen.r) == doctest::Approx(expected.r).epsilon(0.01));
    CHECK(static_cast<double>(seen.b) == doctest::Approx(expected.b).epsilon(0.01));
    CHECK(seen.b < 0.5f * seen.r);
}
