#pragma once

// BSDFs of random parameters: every lobe and stack, with any parameters that a file may have.

#include <algorithm>
#include <cmath>

#include "math/random.h"
#include "shading/make_reflection.h"

namespace pertev::test {

/// Numbers in [0, 1), each a function of a set's index and of how many were drawn before.
class RandomNumbers {
public:
    explicit RandomNumbers(uint32_t set) : set_(set) {}

    float next() { return unit_interval(hash_words(set_, count_++, 0x9e3779b9u, 17u).x); }
    float between(float low, float high) { return low + (high - low) * next(); }
    bool happens(float probability) { return next() < probability; }
    /// Returns a number in [0, 1] that is 1 half of the time, where most energy is.
    float saturated() { return std::min(2 * next(), 1.0f); }
    Rgb color() {
        const float r = saturated(), g = saturated(), b = saturated();
        return {r, g, b};
    }
    float roughness() { return happens(0.1f) ? 0.0f : next(); }
    /// Returns an index from 1 to 3, or rarely one below 1, as that of a bubble.
    float ior() { return happens(0.1f) ? between(0.4f, 1) : between(1, 3); }
    Vec2 tangent() {
        const float turn = 6.2831853f * next();
        return {std::cos(turn), std::sin(turn)};
    }
    /// Returns a direction on either side; half of them are near the horizon.
    Vec3 direction() {
        const float z = happens(0.5f) ? next() : std::pow(10.0f, -5.0f * next()), side = happens(0.5f) ? 1.0f : -1.0f;
        const Vec2 around = tangent();
        const float across = std::sqrt((1.0f - z) * (1.0f + z));
        return {across * around.x, across * around.y, side * z};
    }

private:
    uint32_t set_, count_ = 0;
};

inline ReflectionParameters random_parameters(RandomNumbers& numbers) {
    ReflectionParameters p = {.base_color = numbers.color(), .roughness = numbers.roughness(), .ior = numbers.ior()};
    if (numbers.happens(0.6f)) p.metallic = numbers.saturated();
    if (numbers.happens(0.3f)) p.weight = numbers.next();
    if (numbers.happens(0.3f)) p.color = 4.0f * numbers.color();
    if (numbers.happens(0.2f)) p.through = numbers.saturated();
    if (numbers.happens(0.2f)) p.translucent = numbers.saturated(), p.translucent_color = numbers.color();
    if (numbers.happens(0.3f)) p.solid = numbers.saturated();
    if (numbers.happens(0.3f)) p.anisotropy = numbers.next(), p.along = numbers.tangent();
    if (numbers.happens(0.2f)) {
        p.film = {
            .weight = numbers.saturated(), .ior = numbers.between(1, 2.5f), .thickness = numbers.between(0, 1.2f)};
    }
    if (numbers.happens(0.3f)) p.diffuse_roughness = numbers.next();
    if (numbers.happens(0.4f)) p.dispersion = numbers.between(0, 0.3f);
    if (numbers.happens(0.3f)) p.metal_tint = numbers.color();
    if (numbers.happens(0.2f)) p.retroreflectivity = numbers.saturated();
    p.is_beckmann = numbers.happens(0.3f);
    p.is_single = numbers.happens(0.15f);
    return p;
}

/// Returns a lobe or a reflection with everything that lies beneath one.
inline Bsdf random_uncoated_bsdf(RandomNumbers& numbers) {
    const int kind = static_cast<int>(10 * numbers.next());
    const ReflectionParameters p = random_parameters(numbers);
    switch (kind) {
    case 0:
        return make_rough_diffuse(p.base_color, p.diffuse_roughness);
    case 1: { // some of these metals absorb nothing
        const Rgb eta = (numbers.happens(0.3f) ? 0.0f : 2.0f) * numbers.color(), k = 5.0f * numbers.color();
        return make_metal(eta, k, p);
    }
    case 2:
        return make_dielectric(p.ior, p.roughness, p.base_color);
    case 3:
        return make_metallic_roughness(p.base_color, p.metallic, p.roughness, p.ior);
    case 4:
        return {};
    default:
        return make_reflection(p);
    }
}

inline void add_random_layer(Bsdf& bsdf, RandomNumbers& numbers) {
    const int kind = static_cast<int>(4 * numbers.next());
    const Rgb color = numbers.color();
    const float roughness = numbers.roughness();
    if (kind == 0) return add_sheen(bsdf, color, roughness);
    if (kind == 1) return add_fuzz(bsdf, color, roughness);
    const float strength = numbers.saturated(), ior = numbers.between(1, 2.5f);
    Vec3 normal = {0, 0, 1};
    if (numbers.happens(0.3f)) {
        const float x = numbers.between(-0.6f, 0.6f), y = numbers.between(-0.6f, 0.6f);
        normal = normalize(Vec3{x, y, 1});
    }
    Stretch stretch;
    if (numbers.happens(0.3f)) stretch = {numbers.tangent(), numbers.next()};
    add_coat(bsdf, strength, roughness, ior, normal, numbers.happens(0.4f) ? color : Rgb{1, 1, 1}, stretch);
}

/// Returns a BSDF with up to two layers on all else.
inline Bsdf random_bsdf(RandomNumbers& numbers) {
    Bsdf bsdf = random_uncoated_bsdf(numbers);
    for (int i = 0; i < 2; ++i)
        if (numbers.happens(0.4f)) add_random_layer(bsdf, numbers);
    return bsdf;
}

} // namespace pertev::test
