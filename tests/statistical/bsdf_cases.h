#pragma once

// The BSDFs that the statistical tests hold to their promises, and what those tests share.

#include <cmath>
#include <string>
#include <vector>

#include "math/random.h"
#include "math/sampler.h"
#include "shading/bsdf.h"

namespace pertev::test {

struct BsdfCase {
    std::string name;
    Bsdf bsdf;
};

inline constexpr Rgb kGoldEta = {0.2f, 0.92f, 1.1f}, kGoldK = {3.9f, 2.45f, 2.14f};

/// One of each kind at several roughnesses; lobes that are not delta.
inline std::vector<BsdfCase> rough_bsdf_cases() {
    std::vector<BsdfCase> cases = {{"diffuse", make_diffuse({0.8f, 0.5f, 0.2f})}};
    for (const float r : {0.1f, 0.3f, 0.6f, 1.0f}) {
        const std::string at = " of roughness " + std::to_string(r);
        cases.push_back({"gold" + at, make_conductor(kGoldEta, kGoldK, r)});
        cases.push_back({"glass" + at, make_dielectric(1.5f, r, {1.0f, 0.9f, 0.7f})});
        cases.push_back({"plastic" + at, make_metallic_roughness({0.2f, 0.5f, 0.8f}, 0, r, 1.5f)});
    }
    cases.push_back({"half a metal", make_metallic_roughness({0.9f, 0.5f, 0.1f}, 0.5f, 0.4f, 1.5f)});
    cases.push_back({"glTF metal", make_metallic_roughness({0.9f, 0.5f, 0.1f}, 1, 0.5f, 1.5f)});
    cases.push_back({"mirror coat", make_metallic_roughness({0.2f, 0.5f, 0.8f}, 0, 0, 1.5f)});
    cases.push_back({"glass of index 1.1", make_dielectric(1.1f, 0.5f, grey(1))});
    cases.push_back({"glass of index 2.4", make_dielectric(2.4f, 0.35f, grey(1))});
    return cases;
}

/// Unit vector at height `z` in [-1, 1], `turns` of a full turn about the normal.
inline Vec3 direction_at(float z, float turns = 0.1f) {
    const float across = std::sqrt((1.0f - z) * (1.0f + z)), angle = 6.2831853f * turns;
    return {across * std::cos(angle), across * std::sin(angle), z};
}

struct SamplePoint {
    float lobe;
    Vec2 u;
};

/// Independent points, by index and seed.
inline SamplePoint random_point(uint32_t i, uint32_t seed) {
    const Hash4 h = hash_words(i, seed, 0x9e3779b9u, i ^ seed);
    return {unit_interval(h.x), {unit_interval(h.y), unit_interval(h.z)}};
}

/// Point i of a rank-1 sequence in three dimensions (powers of the inverse of the root of x^4 = x + 1): the mean of
/// a smooth function over n of them is off by about 1 / n.
inline SamplePoint even_point(uint64_t i) {
    const auto turn = [i](double a) {
        const double x = 0.5 + a * static_cast<double>(i + 1);
        return static_cast<float>(x - std::floor(x)) * 0x1.fffffep-1f;
    };
    const float lobe = turn(0.8191725133961645), x = turn(0.6710436067037893), y = turn(0.5497004779019703);
    return {lobe, {x, y}};
}

struct MeanWeight {
    double r = 0, g = 0, b = 0;
    double largest() const { return std::fmax(r, std::fmax(g, b)); }
    double least() const { return std::fmin(r, std::fmin(g, b)); }
};

/// Mean of sample()'s weight over `count` even points: the light that a closed furnace of radiance 1 sends to wo.
inline MeanWeight mean_weight(const Bsdf& bsdf, Vec3 wo, uint64_t count) {
    MeanWeight mean;
    for (uint64_t i = 0; i < count; i++) {
        const SamplePoint p = even_point(i);
        const BsdfSample s = bsdf.sample(wo, p.lobe, p.u);
        if (!(s.pdf > 0)) continue;
        mean.r += static_cast<double>(s.weight.r);
        mean.g += static_cast<double>(s.weight.g);
        mean.b += static_cast<double>(s.weight.b);
    }
    const double scale = 1.0 / static_cast<double>(count);
    return {scale * mean.r, scale * mean.g, scale * mean.b};
}

} // namespace pertev::test
