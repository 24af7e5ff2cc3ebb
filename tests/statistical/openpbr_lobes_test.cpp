// Lobes with parameters of OpenPBR and of other renderers' files: the light that they return, and known values.

#include <doctest/doctest.h>

#include <algorithm>

#include "shading/follow_channel.h"
#include "tests/statistical/bsdf_cases.h"
#include "tests/support/options.h"

using namespace pertev;
using namespace pertev::test;

namespace {

constexpr float kLobeRoughnesses[] = {0.05f, 0.1f, 0.2f, 0.35f, 0.5f, 0.75f, 1.0f};
constexpr float kLobeCosines[] = {3e-3f, 0.03f, 0.12f, 0.35f, 0.65f, 1.0f};

/// The smallest and largest mean weight of what `make` makes of each roughness, over all angles on one side.
template <class Make>
MeanWeight light_range(const Make& make, float side = 1, uint32_t points = 1 << 13) {
    double least = 1e9, largest = 0;
    for (const float roughness : kLobeRoughnesses)
        for (const float cosine : kLobeCosines) {
            const MeanWeight mean = mean_weight(make(roughness), direction_at(side * cosine),
                                                static_cast<uint32_t>(effort(points, 1 << 20)));
            least = std::min(least, mean.least());
            largest = std::max(largest, mean.largest());
        }
    return {least, 0, largest};
}

/// Integral of eval over all directions: heights by midpoints of z = x^2, angles evenly.
double integrated_albedo(const Bsdf& bsdf, Vec3 wo, int heights = 400, int angles = 200) {
    double sum = 0;
    for (int i = 0; i < heights; ++i)
        for (int j = 0; j < angles; ++j) {
            const double x = (i + 0.5) / heights;
            const Vec3 wi = direction_at(static_cast<float>(x * x), static_cast<float>((j + 0.5) / angles));
            sum += 2 * x * static_cast<double>(bsdf.eval(wo, wi).g);
        }
    return sum * 2 * 3.14159265358979 / heights / angles;
}

/// Largest weight of a sample, as the mean of its channels, over a grid of numbers.
float largest_weight(const Bsdf& bsdf) {
    float largest = 0;
    for (const float cosine : kLobeCosines)
        for (uint32_t i = 0; i < 1 << 13; ++i) {
            const SamplePoint p = even_point(i, 1 << 13);
            const BsdfSample s = bsdf.sample(direction_at(cosine), p.lobe, p.u);
            if (s.pdf > 0) largest = std::max(largest, (s.weight.r + s.weight.g + s.weight.b) / 3);
        }
    return largest;
}

} // namespace

TEST_CASE("white rough diffuse returns all light to 0.1 % at every roughness and angle") {
    for (const float roughness : {0.01f, 0.1f, 0.3f, 0.6f, 1.0f})
        for (const float cosine : {0.01f, 0.1f, 0.3f, 0.6f, 0.9f, 1.0f}) {
            const Bsdf bsdf = make_rough_diffuse(grey(1), roughness);
            const double albedo = integrated_albedo(bsdf, direction_at(cosine));
            INFO("roughness " << roughness << ", cosine " << cosine << ": " << albedo);
            CHECK(albedo > 0.999);
            CHECK(albedo < 1.001);
            CHECK(mean_weight(bsdf, direction_at(-cosine), 1 << 16).g == doctest::Approx(albedo).epsilon(2e-3));
        }
}

TEST_CASE(
    "rough diffuse is Lambert's at roughness 0, sends light back where it is rough, and has the published values") {
    const Rgb albedo = {0.8f, 0.5f, 0.2f};
    CHECK(make_rough_diffuse(albedo, 0).is_diffuse());
    const Bsdf lambert = make_diffuse(albedo), near = make_rough_diffuse(albedo, 1e-5f);
    const Bsdf rough = make_rough_diffuse(albedo, 1);
    for (uint32_t i = 0; i < 200; ++i) {
        const SamplePoint p = random_point(i, 5), q = random_point(i, 6);
        const Vec3 wo = direction_at(2.0f * p.u.x - 1.0f, p.u.y), wi = direction_at(2.0f * q.u.x - 1.0f, q.u.y);
        CHECK(near.eval(wo, wi).g == doctest::Approx(lambert.eval(wo, wi).g).epsilon(1e-4));
    }
    const Vec3 wo = direction_at(0.3f, 0), back = wo, forward = direction_at(0.3f, 0.5f);
    CHECK(rough.eval(wo, back).g > 1.5f * lambert.eval(wo, back).g);
    CHECK(rough.eval(wo, forward).g < 0.6f * lambert.eval(wo, forward).g);
    // By the listing of the paper (section 3), in double: roughness 0.5, cosines 0.6 and 0.4, 60 degrees between.
    const Vec3 i = direction_at(0.6f, 0), o = direction_at(0.4f, 1.0f / 6);
    const Rgb f = (1 / 0.6f) * make_rough_diffuse(albedo, 0.5f).eval(o, i);
    CHECK(f.r == doctest::Approx(0.302214).epsilon(1e-4));
    CHECK(f.g == doctest::Approx(0.186033).epsilon(1e-4));
    CHECK(f.b == doctest::Approx(0.0733387).epsilon(1e-4));
    // The average albedo is that of light from everywhere.
    double sum = 0;
    for (int k = 0; k < 200; ++k) {
        const double x = (k + 0.5) / 200;
        sum += 2 * x * integrated_albedo(rough, direction_at(static_cast<float>(x)), 100, 60) / 200;
    }
    CHECK(static_cast<double>(rough.diffuse_albedo().g) == doctest::Approx(sum).epsilon(2e-3));
}

TEST_CASE("a white rough base beneath a reflection returns all light to 1 %, and gains none beneath any layer") {
    for (const float diffuse_roughness : {0.1f, 0.5f, 1.0f}) {
        const MeanWeight glossy = light_range([&](float r) {
            return make_reflection({.base_color = grey(1), .roughness = r, .diffuse_roughness = diffuse_roughness});
        });
        INFO("diffuse roughness " << diffuse_roughness << ": from " << glossy.r << " to " << glossy.largest());
        CHECK(glossy.r > 0.93); // at grazing angles, where light returns towards its source
        CHECK(glossy.b < 1.001);
        const MeanWeight varnished = light_range(
            [&](float r) { return make_coated(make_rough_diffuse(grey(1), diffuse_roughness), 1, r, 1.5f); });
        CHECK(varnished.b < 1.001);
    }
}

TEST_CASE("F82 metal has its colours at 0 and 82 degrees, Schlick's without a tint, and returns all light if white") {
    const Rgb f0 = {0.9f, 0.5f, 0.1f}, tint = {0.2f, 0.6f, 1};
    const Rgb untinted = fresnel_schlick(1.0f / 7, f0), tinted = fresnel_f82(1.0f / 7, f0, tint);
    CHECK(tinted.r == doctest::Approx(0.2f * untinted.r).epsilon(1e-4));
    CHECK(tinted.g == doctest::Approx(0.6f * untinted.g).epsilon(1e-4));
    CHECK(tinted.b == doctest::Approx(untinted.b).epsilon(1e-5));
    CHECK(fresnel_f82(1, f0, tint).r == doctest::Approx(0.9f).epsilon(1e-6));
    CHECK(fresnel_f82(0, f0, tint).r == 1);
    CHECK(fresnel_f82(0.5f, 0, 0) == 0); // clamped
    double sum = 0;
    for (int i = 0; i < 10'000; ++i) {
        const float x = (static_cast<float>(i) + 0.5f) / 10'000;
        sum += 2 * static_cast<double>(x * fresnel_f82(x, f0, tint).r) / 10'000;
    }
    CHECK(static_cast<double>(fresnel_f82_average(f0, tint).r) == doctest::Approx(sum).epsilon(1e-4));
    const auto metal = [](Rgb color, Rgb of_edge, float r) {
        return make_reflection({.base_color = color, .metallic = 1, .roughness = r, .metal_tint = of_edge});
    };
    // The tint is stored in 16 bits, so this one takes the lobe of tints.
    const MeanWeight white = light_range([&](float r) { return metal(grey(1), {1, 1, 0.99999f}, r); }, 1, 1 << 16);
    INFO("white: from " << white.r << " to " << white.b);
    CHECK(white.r > 0.999);
    CHECK(white.b < 1.0005);
    const Bsdf smooth = metal(f0, tint, 0), rough = metal(f0, tint, 0.1f);
    CHECK(smooth.specular(direction_at(1.0f / 7)).mirror.r == doctest::Approx(tinted.r).epsilon(1e-3));
    CHECK(mean_weight(rough, direction_at(0.9f), 1 << 14).r ==
          doctest::Approx(static_cast<double>(fresnel_f82(0.9f, f0, tint).r)).epsilon(5e-3));
}

TEST_CASE("Beckmann's metal, plastic and glass return all light if compensated, and less by one bounce") {
    // The light of one bounce is far from its bounds, so half the points are enough.
    const auto points = [](bool is_single) { return is_single ? 1u << 12 : 1u << 13; };
    for (const bool is_beckmann : {false, true}) {
        const auto metal = [&](bool is_single) {
            return light_range(
                [&](float r) {
                    return make_metal(
                        grey(0), grey(2),
                        {.base_color = {}, .roughness = r, .is_beckmann = is_beckmann, .is_single = is_single});
                },
                1, points(is_single));
        };
        const MeanWeight all = metal(false), single = metal(true);
        INFO("Beckmann " << is_beckmann << ": from " << all.r << " to " << all.largest() << ", single from "
                         << single.least());
        CHECK(all.r > (is_beckmann ? 0.9975 : 0.998));
        CHECK(all.b < 1.001);
        CHECK(single.r < (is_beckmann ? 0.6 : 0.5));
        CHECK(single.b < 1.001);
        for (const float side : {1.0f, -1.0f})
            for (const float ior : {1.1f, 1.5f, 2.4f}) {
                const auto glass = [&](bool is_single) {
                    return light_range(
                        [&](float r) {
                            return make_reflection({.base_color = grey(1),
                                                    .roughness = r,
                                                    .ior = ior,
                                                    .solid = 1,
                                                    .anisotropy = is_beckmann || is_single ? 0.0f : 1e-6f,
                                                    .is_beckmann = is_beckmann,
                                                    .is_single = is_single});
                        },
                        side, points(is_single));
                };
                const MeanWeight compensated = glass(false), once = glass(true);
                CAPTURE(ior);
                CAPTURE(side);
                CAPTURE(once.r);
                CAPTURE(compensated.r);
                CAPTURE(compensated.b);
                CHECK(compensated.r > (side > 0 ? 0.997 : is_beckmann ? 0.98 : 0.995));
                CHECK(compensated.b < 1.001);
                CHECK(once.r < compensated.r - 0.01);
                CHECK(once.b < 1.001);
            }
        const auto plastic = [&](bool is_single) {
            return light_range(
                [&](float r) {
                    return make_reflection({.base_color = grey(1),
                                            .roughness = r,
                                            .ior = 1.8f,
                                            .anisotropy = 1e-6f,
                                            .is_beckmann = is_beckmann,
                                            .is_single = is_single});
                },
                1, points(is_single));
        };
        const MeanWeight more = plastic(false);
        CHECK(more.r > 0.85);
        CHECK(more.b < 1.001);
        CHECK(plastic(true).b < 1.001);
    }
}

TEST_CASE(
    "weights are below 1.5 for rough diffuse, one bounce and Beckmann's metal, 2 for its glass, 4.2 for GGX's metal") {
    for (const float r : kLobeRoughnesses) {
        CAPTURE(r);
        CHECK(largest_weight(make_rough_diffuse(grey(1), r)) < 1.5f);
        for (const bool is_single : {false, true})
            for (const bool is_beckmann : {false, true}) {
                CAPTURE(is_single);
                CAPTURE(is_beckmann);
                const ReflectionParameters p = {.base_color = grey(1),
                                                .roughness = r,
                                                .solid = 1,
                                                .is_beckmann = is_beckmann,
                                                .is_single = is_single};
                const bool is_bounded = is_single || is_beckmann; // bsdf_weights_test.cpp has the reason
                const float of_metal = largest_weight(make_metal(grey(0), grey(2), p));
                CHECK(of_metal < (is_bounded ? 1.5f : r < 0.2f ? 4.2f : 1.9f));
                if (is_bounded) CHECK(largest_weight(make_reflection(p)) < (is_single ? 1.5f : 2.0f));
            }
    }
}

TEST_CASE("retroreflection sends light back towards its source, as much as the mirror would forwards") {
    const auto sign = [](float roughness, float share, Rgb color = grey(1), float metallic = 1) {
        return make_reflection(
            {.base_color = color, .metallic = metallic, .roughness = roughness, .retroreflectivity = share});
    };
    const Rgb color = {0.9f, 0.5f, 0.1f};
    const Bsdf usual = make_reflection({.base_color = color, .metallic = 0.5f, .roughness = 0.4f});
    const Bsdf all = sign(0.4f, 1, color, 0.5f), part = sign(0.4f, 0.25f, color, 0.5f);
    for (uint32_t i = 0; i < 200; ++i) {
        const SamplePoint p = random_point(i, 15), q = random_point(i, 16);
        const Vec3 wo = direction_at(2.0f * p.u.x - 1.0f, p.u.y), wi = direction_at(2.0f * q.u.x - 1.0f, q.u.y);
        const Rgb forwards = usual.eval(wo, wi), back = usual.eval({-wo.x, -wo.y, wo.z}, wi);
        CHECK(all.eval(wo, wi).g == doctest::Approx(back.g).epsilon(2e-3).scale(1e-3));
        CHECK(part.eval(wo, wi).r == doctest::Approx(0.75f * forwards.r + 0.25f * back.r).epsilon(2e-3).scale(1e-3));
    }
    const Vec3 wo = direction_at(0.6f, 0.1f);
    CHECK(sign(0.2f, 1).eval(wo, wo).g > 100 * sign(0.2f, 1).eval(wo, {-wo.x, -wo.y, wo.z}).g);
    for (const float share : {0.3f, 1.0f})
        for (const float metallic : {0.0f, 1.0f}) {
            const MeanWeight white = light_range([&](float r) { return sign(r, share, grey(1), metallic); });
            INFO("share " << share << ": from " << white.r << " to " << white.largest());
            CHECK(white.r > 0.99);
            CHECK(white.b < 1.001);
        }
    for (const float r : kLobeRoughnesses) { // no more than forwards
        CHECK(largest_weight(sign(r, 0.5f)) < 1.01f * largest_weight(sign(r, 0)));
    }
    CHECK(!sign(0, 1).has_delta());
}

TEST_CASE("dispersed glass refracts each channel by its own index, keeps all light, and is sampled by its density") {
    const auto glass = [](float roughness, Rgb tint = grey(1)) {
        return make_reflection(
            {.base_color = tint, .roughness = roughness, .ior = 1.5f, .solid = 1, .dispersion = 0.2f});
    };
    const float iors[] = {1.45f, 1.5f, 1.55f};
    const Bsdf smooth = glass(0);
    const Vec3 wo = direction_at(0.6f);
    bool is_found[3] = {};
    for (uint32_t i = 0; i < 1000; ++i) {
        const SamplePoint p = even_point(i, 1000);
        const BsdfSample s = smooth.sample(wo, p.lobe, p.u);
        REQUIRE(s.is_delta());
        const float weights[] = {s.weight.r, s.weight.g, s.weight.b};
        if (!s.is_transmission) {
            const float sum = weights[0] + weights[1] + weights[2];
            CHECK(sum == doctest::Approx(3).epsilon(1e-4)); // the mean is 1
            for (int c = 0; c < 3; ++c)
                CHECK(weights[c] * s.pdf ==
                      doctest::Approx(fresnel_dielectric(0.6f, iors[c]).reflectance).epsilon(1e-3));
            continue;
        }
        for (int c = 0; c < 3; ++c) {
            if (!(weights[c] > 0)) continue;
            is_found[c] = true;
            CHECK(weights[c] == doctest::Approx(3).epsilon(1e-4));
            CHECK(std::hypot(s.wi.x, s.wi.y) * iors[c] == doctest::Approx(0.8f).epsilon(1e-4));
        }
    }
    CHECK((is_found[0] && is_found[1] && is_found[2]));
    for (const float side : {1.0f, -1.0f}) {
        const MeanWeight range = light_range([&](float r) { return glass(r); }, side);
        INFO("side " << side << ": from " << std::min(range.r, range.b) << " to " << range.largest());
        CHECK(range.r > 0.985);
        CHECK(range.b < 1.002);
    }
    const Bsdf rough = glass(0.6f, {1.0f, 0.9f, 0.7f});
    for (const float cosine : {0.9f, -0.5f}) {
        double light = 0, density = 0;
        constexpr uint32_t kPoints = 1 << 18;
        for (uint32_t i = 0; i < kPoints; ++i) {
            const SamplePoint p = even_point(i, kPoints);
            const BsdfValue at = rough.evaluate(direction_at(cosine), direction_at(2.0f * p.u.x - 1.0f, p.u.y));
            light += 4 * 3.14159265358979 * static_cast<double>(at.f.b) / kPoints;
            density += 4 * 3.14159265358979 * static_cast<double>(at.pdf) / kPoints;
        }
        double drawn = 0;
        for (uint32_t i = 0; i < 1 << 16; ++i) {
            const SamplePoint p = even_point(i, 1 << 16);
            if (rough.sample(direction_at(cosine), p.lobe, p.u).pdf > 0) drawn += 1.0 / (1 << 16);
        }
        CHECK(light == doctest::Approx(mean_weight(rough, direction_at(cosine), 1 << 18).b).epsilon(3e-3));
        CHECK(density == doctest::Approx(drawn).epsilon(3e-3));
    }
    CHECK(largest_weight(rough) < 1.5f);
}

TEST_CASE("light of one colour is refracted by its own index, with a weight that does not grow") {
    const auto glass = [](float roughness) {
        return make_reflection(
            {.base_color = grey(1), .roughness = roughness, .ior = 1.5f, .solid = 1, .dispersion = 0.2f});
    };
    for (const float roughness : {0.0f, 0.5f})
        for (int channel = 0; channel < 3; ++channel) {
            const Rgb alone = {channel == 0 ? 0.5f : 0.0f, channel == 1 ? 0.5f : 0.0f, channel == 2 ? 0.5f : 0.0f};
            Bsdf bsdf = glass(roughness);
            follow_channel(alone, bsdf);
            CHECK(bsdf.layers[0].glass.ior == doctest::Approx(1.45 + 0.05 * channel).epsilon(1e-5));
            CHECK(bsdf.layers[0].glass.spread == 0.0f);
            CHECK(largest_weight(bsdf) < (roughness > 0 ? 2.0f : 1.001f));
            Bsdf white = glass(roughness);
            follow_channel({0.5f, 0, 0.1f}, white);
            CHECK(white.layers[0].glass.spread > 0.0f);
            // The channel has the value that all three together give it.
            const Vec3 wo = direction_at(0.7f), wi = direction_at(-0.8f, 0.5f);
            const auto of = [&](Rgb color) { return channel == 0 ? color.r : channel == 1 ? color.g : color.b; };
            CHECK(of(bsdf.eval(wo, wi)) == doctest::Approx(of(white.eval(wo, wi))).epsilon(1e-5));
        }
    Bsdf plain = make_dielectric(1.5f, 0, grey(1));
    follow_channel({1, 0, 0}, plain);
    CHECK(plain.base.dielectric.ior == 1.5f);
}
