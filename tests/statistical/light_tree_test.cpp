// A light tree by itself: draws have the probabilities that it reports, which leave out no light, do not depend on the
// unit of length, and have at most the variance of a published tree.

#include "shading/light_tree/light_tree.h"

#include <doctest/doctest.h>

#include <cstring>
#include <map>
#include <utility>

#include "base/parallel_for.h"
#include "tests/support/chi_square.h"
#include "tests/support/many_lights.h"
#include "tests/support/options.h"
#include "tests/support/pbrt_light_bvh.h"

using namespace pertev;

namespace {

constexpr uint64_t kAllNumbers = uint64_t(1) << 63;

uint64_t random_number(test::Random& random) {
    const uint64_t high = random.bits();
    return (high << 32 | random.bits()) >> 1;
}

/// Lights of all kinds: with one and with two faces, points and spots, large and small.
std::vector<TreeLight> make_mixed_lights(uint32_t count) {
    std::vector<TreeLight> lights(count);
    test::Random random(23);
    for (TreeLight& light : lights) {
        const Vec3 at = random.point(-3, 3);
        const uint32_t kind = random.below(4);
        light.bounds.extend(at);
        if (kind < 2) light.bounds.extend(at + random.point(-0.5f, 0.5f));
        light.axis = random.direction();
        light.emission_angle = kind == 2 ? kPi : kind == 3 ? 0.4f : 0.5f * kPi;
        light.has_two_sides = kind == 1;
        light.power = static_cast<double>(random.within(0.01f, 1));
    }
    lights[count / 2].power = 0;
    return lights;
}

std::vector<LightReceiver> make_receivers(uint32_t count) {
    std::vector<LightReceiver> receivers;
    test::Random random(29);
    for (uint32_t i = 0; i < count; ++i) {
        const Vec3 point = random.point(-6, 6);
        receivers.push_back({point, i % 3 == 0 ? Vec3{} : random.direction()});
    }
    return receivers;
}

/// Returns whether a light may reach the receiver: its middle lies ahead, and the receiver in the light's directions.
bool may_reach(const TreeLight& light, const LightReceiver& to) {
    const Vec3 way = normalize(light.bounds.centre() - to.point);
    if (to.has_normal() && !(dot(way, to.normal) > 0)) return false;
    const float cosine = -dot(way, light.axis);
    return light.emission_angle >= kPi ||
           (light.has_two_sides ? std::abs(cosine) : cosine) > std::cos(light.emission_angle);
}

struct Variances {
    double tree = 0, power = 0, oracle = 0;
};

/// Relative variances of the light of one draw, without occlusion: means over the receivers.
Variances variances_of(const test::ManyLights& scene, TreeLights tree) {
    const std::vector<TreeLight> lights = scene.tree_lights();
    const LightTreeData data = build_light_tree(std::move(tree));
    const test::PbrtLightBvh oracle(lights);
    double power = 0, count = 0;
    for (const TreeLight& light : lights) power += light.power;
    Variances sum;
    for (const LightReceiver& to : scene.receivers) {
        double light = 0, by_power = 0, by_tree = 0, by_oracle = 0, lit_by_tree = 0;
        std::vector<double> arriving;
        for (std::size_t i = 0; i < lights.size(); ++i) {
            arriving.push_back(test::light_at(scene.lights[i], to));
            light += arriving[i];
            by_power += arriving[i] * arriving[i] * power / lights[i].power;
        }
        if (!(light > 0)) continue;
        test::visit_tree(data.view(), to, [&](uint32_t i, double p) {
            by_tree += arriving[i] * arriving[i] / p;
            lit_by_tree += arriving[i];
        });
        oracle.visit(to.point, to.normal, [&](uint32_t i, double p) { by_oracle += arriving[i] * arriving[i] / p; });
        CHECK(lit_by_tree == doctest::Approx(light).epsilon(1e-9)); // no light that arrives is left out
        const double square = light * light;
        sum.tree += by_tree / square - 1, sum.power += by_power / square - 1, sum.oracle += by_oracle / square - 1;
        count += 1;
    }
    return {sum.tree / count, sum.power / count, sum.oracle / count};
}
Variances variances_of(const test::ManyLights& scene) { return variances_of(scene, {scene.tree_lights()}); }

/// Lights of all kinds, and copies of others that share two subtrees: turned, smaller, larger, mirrored. The second
/// subtree's normals lie in a narrow cone, outside of which it is dark.
test::SharedLights make_shared_lights() {
    test::SharedLights all;
    all.lights = make_mixed_lights(60);
    all.tree.lights = all.lights;
    all.tree.shared = {make_mixed_lights(80), {}};
    for (TreeLight light : make_mixed_lights(20)) {
        light.axis = normalize(light.axis + Vec3{0, 0, 4});
        light.emission_angle = min(light.emission_angle, 0.5f * kPi);
        light.has_two_sides = false;
        all.tree.shared[1].push_back(light);
    }
    all.place(0, test::make_similarity({0, 0, 1}, 0, 1, {2, 0, 0}));
    all.place(0, test::make_similarity({0.6f, 0, 0.8f}, 1.1f, 0.25f, {-4, 1, 0}));
    all.place(0, test::make_similarity({0, 0.8f, 0.6f}, -2.3f, -2, {0, 9, 3}));
    all.place(1, test::make_similarity({0.6f, 0.8f, 0}, 2.2f, 0.1f, {1, 1, 0}));
    all.place(1, test::make_similarity({0, 0.8f, 0.6f}, 0.9f, -0.2f, {0, -1, 1}));
    return all;
}

} // namespace

TEST_CASE("a light tree draws lights with the probabilities that it reports, to the bit") {
    const auto [tree_lights, lights] = make_shared_lights();
    const LightTreeData data = build_light_tree(tree_lights);
    REQUIRE(data.light_count == 59 + 3 * 79 + 2 * 19);
    REQUIRE(data.nodes.size() == 2 * (59 + 5 + 79 + 19)); // the copies share theirs
    test::Random random(1);
    for (const LightReceiver& to : make_receivers(24)) {
        const LightTreeView tree = data.view();
        std::vector<double> drawn(lights.size() + 1), expected(lights.size() + 1);
        constexpr uint32_t kDraws = 40'000;
        uint32_t wrong = 0;
        double sum = 0;
        for (uint32_t i = 0; i < lights.size(); ++i) {
            const double p = static_cast<double>(pmf_in_tree(tree, to, i));
            if (lights[i].power > 0 && may_reach(lights[i], to)) CHECK(p > 0);
            sum += p;
            expected[i] = kDraws * p;
        }
        const double none = test::visit_tree(tree, to, [](uint32_t, double) {});
        CHECK(sum + none == doctest::Approx(1).epsilon(1e-5));
        expected.back() = kDraws * none;
        for (uint32_t i = 0; i < kDraws; ++i) {
            const LightTreeDraw draw = draw_from_tree(tree, to, random_number(random), kAllNumbers);
            if (draw.light == LightTreeDraw::kNoLeaf) {
                drawn.back() += 1;
                continue;
            }
            drawn[draw.light] += 1;
            wrong += draw.pmf == pmf_in_tree(tree, to, draw.light) && draw.rest >= 0 && draw.rest < 1 ? 0 : 1;
        }
        CHECK(wrong == 0);
        const test::ChiSquareResult result = test::chi_square(drawn, expected);
        CHECK_MESSAGE(result.passes(24), result.describe());
    }
}

TEST_CASE("a light tree's probabilities do not depend on the unit of length or of power") {
    const std::vector<TreeLight> lights = make_mixed_lights(200);
    const LightTreeData data = build_light_tree({lights});
    for (const float scale : {1024.0f, 0x1p-12f}) {
        std::vector<TreeLight> scaled = lights;
        for (TreeLight& light : scaled) {
            light.bounds = {scale * light.bounds.lo, scale * light.bounds.hi};
            light.power *= 64;
        }
        const LightTreeData other = build_light_tree({scaled});
        uint32_t differ = 0;
        for (const LightReceiver& to : make_receivers(30)) {
            for (uint32_t i = 0; i < lights.size(); ++i) {
                const float scaled_pmf = pmf_in_tree(other.view(), {scale * to.point, to.normal}, i);
                differ += scaled_pmf != pmf_in_tree(data.view(), to, i) ? 1 : 0;
            }
        }
        CHECK(differ == 0);
    }
}

TEST_CASE("copies of lights that share a subtree have the same probabilities for a receiver that moves with them") {
    const std::vector<TreeLight> lights = make_mixed_lights(80);
    const Transform placed = test::make_similarity({0.6f, 0, 0.8f}, 1.1f, -3, {-4, 1, 0});
    test::SharedLights copy;
    copy.tree.shared.push_back(lights);
    copy.place(0, placed);
    const LightTreeData own = build_light_tree({lights}), shared = build_light_tree(copy.tree);
    uint32_t lit = 0;
    double most = 0;
    for (const LightReceiver& to : make_receivers(30)) {
        const Vec3 normal = to.has_normal() ? normalize(transform_vector(placed, to.normal)) : Vec3{};
        const LightReceiver moved = {transform_point(placed, to.point), normal};
        if (!(importance_of(shared.nodes[kLightTreeRoot], moved).most > 0)) continue;
        ++lit;
        for (uint32_t i = 0; i < lights.size(); ++i) {
            const auto p = static_cast<double>(pmf_in_tree(own.view(), to, i));
            const auto by_shared = static_cast<double>(pmf_in_tree(shared.view(), moved, i));
            most = std::max(most, std::abs(by_shared - p) / (p + 1e-5));
        }
    }
    CHECK(lit > 25);
    CHECK(most < 0.01);
    CHECK(is_similarity(placed));
    for (const Vec3 sizes : {Vec3{1.01f, 1, 1}, Vec3{1, 1.01f, 1}, Vec3{1, 1, 1.01f}, Vec3{0, 0, 0}}) {
        Transform stretched = placed; // along an axis of the mesh
        for (Vec3* const row : {&stretched.row0, &stretched.row1, &stretched.row2})
            *row = {sizes.x * row->x, sizes.y * row->y, sizes.z * row->z};
        CHECK_FALSE(is_similarity(stretched));
    }
    CHECK_FALSE(is_similarity({{1, 0.01f, 0}, {0, 1, 0}, {0, 0, 1}, {}}));
}

TEST_CASE("a larger number never selects an earlier leaf, and the rest of it is even within a light") {
    const LightTreeData data = build_light_tree({make_mixed_lights(300)});
    for (const LightReceiver& to : make_receivers(6)) {
        uint32_t earlier = 0, last = 0;
        double rests = 0;
        constexpr uint32_t kNumbers = 20'000;
        std::vector<uint32_t> order; // leaves from the first on
        test::visit_tree(data.view(), to, [&](uint32_t light, double) { order.push_back(light); });
        std::map<uint32_t, uint32_t> place;
        for (uint32_t i = 0; i < order.size(); ++i) place[order[i]] = i;
        uint32_t count = 0;
        for (uint32_t i = 0; i < kNumbers; ++i) {
            const LightTreeDraw draw = draw_from_tree(data.view(), to, kAllNumbers / kNumbers * i, kAllNumbers);
            if (draw.light == LightTreeDraw::kNoLeaf) continue;
            earlier += place.at(draw.light) < last ? 1 : 0;
            last = place.at(draw.light);
            rests += static_cast<double>(draw.rest);
            ++count;
        }
        CHECK(earlier == 0);
        CHECK(rests / count == doctest::Approx(0.5).epsilon(0.02));
    }
}

TEST_CASE("lights at ever smaller distances make a tree that is deep but has each of them") {
    std::vector<TreeLight> lights(126);
    for (std::size_t i = 0; i < lights.size(); ++i) {
        lights[i].bounds.extend(Vec3{std::ldexp(1.0f, static_cast<int>(i / 2) - 40), static_cast<float>(i % 2), 0});
        lights[i].emission_angle = kPi;
        lights[i].power = 1;
    }
    const LightTreeData data = build_light_tree({lights});
    REQUIRE(data.light_count == 126);
    const LightReceiver to = {{-1, 0.5f, 0}, {1, 0, 0}};
    double sum = 0;
    for (uint32_t i = 0; i < 126; ++i) sum += static_cast<double>(pmf_in_tree(data.view(), to, i));
    CHECK(sum == doctest::Approx(1).epsilon(1e-5));
}

TEST_CASE("a light tree that several threads build has each light, and does not depend on their number") {
    const std::vector<TreeLight> lights = test::make_dust(100'000).tree_lights();
    LightTreeData trees[2];
    for (const int threads : {1, 3}) {
        const UseThreads use(threads);
        trees[threads / 2] = build_light_tree({lights});
    }
    const auto& [one, three] = trees;
    REQUIRE(one.nodes.size() == 200'000);
    REQUIRE(three.nodes.size() == 200'000);
    CHECK(std::memcmp(one.nodes.data(), three.nodes.data(), one.nodes.size() * sizeof(LightTreeNode)) == 0);
    CHECK(one.leaf_of_light == three.leaf_of_light);
    uint32_t found = 0;
    for (uint32_t i = 0; i < 100'000; ++i) {
        const LightTreeNode& leaf = one.nodes[one.leaf_of_light[i]];
        found += leaf.is_leaf() && leaf.number() == i ? 1 : 0;
    }
    CHECK(found == 100'000);
}

TEST_CASE("light samples by a tree have little variance, and at most that of a published tree") {
    const Variances corridor = variances_of(test::make_corridor(10'000));
    CHECK(corridor.tree <= 0.6);
    CHECK(corridor.power > 5);
    const Variances hall = variances_of(test::make_hall());
    CHECK(hall.tree < 0.1 * hall.power);
    const Variances city = variances_of(test::make_city(8)), chandelier = variances_of(test::make_chandelier(1000));
    const Variances dust = variances_of(test::make_dust(static_cast<uint32_t>(test::effort(20'000, 1'000'000))));
    test::ManyLights copies = test::make_chandelier(1000);
    test::SharedLights shared;
    shared.tree.shared.push_back(copies.tree_lights());
    const std::vector<test::SmallLight> one = std::exchange(copies.lights, {});
    for (const float x : {-3.0f, 0.0f, 4.0f}) {
        const Transform placed = test::make_similarity({0, 1, 0}, x, 1, {x, 0, 0});
        shared.place(0, placed);
        for (const test::SmallLight& light : one) {
            copies.add(transform_point(placed, light.a), transform_vector(placed, light.ab),
                       transform_vector(placed, light.ac), light.emission);
        }
    }
    const std::pair<std::string, Variances> all[] = {
        {"chandeliers that share a subtree", variances_of(copies, shared.tree)},
        {"corridor", corridor},
        {"hall", hall},
        {"city", city},
        {"chandelier", chandelier},
        {"dust", dust}};
    for (const auto& [name, found] : all) {
        CAPTURE(name);
        MESSAGE(name, ": relative variance by tree ", found.tree, ", by power ", found.power, ", by the oracle ",
                found.oracle);
        CHECK(found.tree <= 1.2 * found.oracle);
    }
}
