// The energy bound over random parameters of every lobe and stack.
//
// A set of parameters is looked at with few points first, and with more as long as its mean weight seems to exceed the
// bound. Few points err by some per cent in both directions, so the first look misses nearly half of the sets that
// exceed it by less; a fault of a lobe is found because hundreds of sets have each parameter of each lobe.

#include <doctest/doctest.h>

#include <array>
#include <sstream>
#include <vector>

#include "base/parallel_for.h"
#include "tests/statistical/bsdf_cases.h"
#include "tests/statistical/random_bsdf.h"
#include "tests/support/options.h"

using namespace pertev;
using namespace pertev::test;

namespace {

/// A set of parameters, a direction, and an offset of the points, so that sets do not err alike.
struct RandomSet {
    Bsdf bsdf;
    Vec3 wo;
    SamplePoint offset;

    explicit RandomSet(uint32_t index, Bsdf (*make)(RandomNumbers&) = random_bsdf) {
        RandomNumbers numbers(index);
        bsdf = make(numbers);
        wo = numbers.direction();
        offset.lobe = numbers.next();
        offset.u.x = numbers.next();
        offset.u.y = numbers.next();
    }

    /// Returns the largest channel of the mean weight over `count` even points.
    double light(uint32_t count) const {
        const auto moved = [](float u, float by) { return std::min(u + by < 1 ? u + by : u + by - 1, 0x1.fffffep-1f); };
        MeanWeight mean;
        for (uint32_t i = 0; i < count; ++i) {
            const SamplePoint p = even_point(i, count);
            const BsdfSample s =
                bsdf.sample(wo, moved(p.lobe, offset.lobe), {moved(p.u.x, offset.u.x), moved(p.u.y, offset.u.y)});
            if (!(s.pdf > 0)) continue;
            mean.r += static_cast<double>(s.weight.r);
            mean.g += static_cast<double>(s.weight.g);
            mean.b += static_cast<double>(s.weight.b);
        }
        return mean.largest() / count;
    }
    std::string describe() const {
        std::ostringstream text;
        text << "base " << static_cast<int>(bsdf.base.kind) << ", layers";
        for (int i = 0; i < bsdf.layer_count; ++i) text << " " << static_cast<int>(bsdf.layers[i].kind);
        text << ", narrowest width " << narrowest_alpha(bsdf) << ", index " << bsdf.inner_ior() << ", cos(wo) " << wo.z;
        return text.str();
    }
};

bool is_uneven(const Microfacets& widths) { return widths.x != widths.y; }
bool is_stretched(const Lobe& lobe) {
    if (lobe.kind == LobeKind::Metal) return is_uneven(lobe.metal.unpacked().widths);
    if (lobe.kind == LobeKind::Filmed) return is_uneven(lobe.filmed.unpacked().widths);
    if (lobe.kind == LobeKind::FilmedRetro) return is_uneven(lobe.filmed_retro.unpacked().lobe.widths);
    if (lobe.kind == LobeKind::Thin) return is_uneven(lobe.thin.widths);
    if (lobe.kind == LobeKind::Glass) return is_uneven(lobe.glass.unpacked().widths);
    return lobe.kind == LobeKind::Coat && (lobe.coat.wide_and_turn.bits & 0xffffu) != 0;
}
template <class Is>
bool any_lobe(const Bsdf& bsdf, const Is& is) {
    for (int i = 0; i < bsdf.layer_count; ++i)
        if (is(bsdf.layers[i])) return true;
    return is(bsdf.base);
}

/// Returns rough glass of an index below 1 with a film, whose reflectance falls most where glass reflects all.
Bsdf random_filmed_bubble(RandomNumbers& numbers) {
    ReflectionParameters p = {.base_color = grey(1), .ior = numbers.between(0.34f, 0.999f), .solid = 1};
    p.roughness = std::max(numbers.next(), 0.04f);
    p.film = {.weight = numbers.saturated(), .ior = numbers.between(1, 2.5f), .thickness = numbers.between(0, 1.2f)};
    if (numbers.happens(0.3f)) p.anisotropy = numbers.next(), p.along = numbers.tangent();
    p.is_beckmann = numbers.happens(0.3f);
    return make_reflection(p);
}

void check_light(uint32_t count, Bsdf (*make)(RandomNumbers&)) {
    constexpr double kMostLight = 1 + 1e-3;
    const auto least = static_cast<uint32_t>(effort(1 << 7, 1 << 11)); // points
    std::vector<double> light(count);
    parallel_for(count, 64, [&](uint64_t i) {
        const RandomSet set(static_cast<uint32_t>(i), make);
        // 2^7 points err by up to 0.05, 2^16 by up to 2e-4.
        for (uint32_t points = least; points <= least << 9; points <<= 3) {
            light[i] = set.light(points);
            if (light[i] <= kMostLight - 5e-4) break;
        }
    });
    for (uint32_t i = 0; i < count; ++i) {
        const RandomSet set(i, make);
        INFO("set " << i << ": " << set.describe() << ", light " << light[i]);
        CHECK(light[i] < kMostLight);
    }
}

} // namespace

TEST_CASE("no bsdf of 10,000 random ones returns more than 1 + 1e-3 of the light") {
    check_light(static_cast<uint32_t>(effort(10'000, 200'000)), random_bsdf);
}

TEST_CASE("no rough bubble behind a film returns more than 1 + 1e-3 of the light") {
    check_light(static_cast<uint32_t>(effort(600, 20'000)), random_filmed_bubble);
}

TEST_CASE("random bsdfs have every lobe and every kind of stack, white ones among them") {
    std::array<int, static_cast<int>(LobeKind::Fuzz) + 1> kinds = {};
    int stacks[Bsdf::kMaxLayers + 1] = {}, full = 0, stretched = 0;
    for (uint32_t i = 0; i < 3000; ++i) {
        const RandomSet set(i);
        ++kinds[static_cast<std::size_t>(set.bsdf.base.kind)];
        for (int k = 0; k < set.bsdf.layer_count; ++k) ++kinds[static_cast<std::size_t>(set.bsdf.layers[k].kind)];
        ++stacks[set.bsdf.layer_count];
        full += set.light(128) > 0.9 ? 1 : 0;
        stretched += any_lobe(set.bsdf, is_stretched) ? 1 : 0;
    }
    for (std::size_t kind = 0; kind < kinds.size(); ++kind) {
        INFO("LobeKind " << kind << ": " << kinds[kind]);
        CHECK(kinds[kind] > 30);
    }
    for (const int sets : stacks) CHECK(sets > 50);
    CHECK(full > 600);
    CHECK(stretched > 300);
    CHECK(stretched < 1500);
}
