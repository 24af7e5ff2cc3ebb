// Lights of a scene selected by a tree: every kind has the density that is reported for a direction found otherwise,
// and the hall of scenes/many-lights has little variance on its floor.

#include "shading/chosen_by_tree.h"

#include <doctest/doctest.h>

#include "formats/read_scene.h"
#include "tests/support/chi_square.h"
#include "tests/support/lit_scenes.h"
#include "tests/support/many_lights.h"

using namespace pertev;

namespace {

/// Squares that shine to one and to both sides, a point light, a spot, a directional light and a sky.
Scene every_light() {
    Scene scene;
    test::add_emitter(scene, test::make_square(2), {3, 2, 1}, make_translation({-2, 2, 0}));
    test::add_emitter(scene, test::make_square(1), {1, 2, 3},
                      compose(make_translation({2, 1, 1}), make_scale({0.3f, -1, 0.3f})));
    test::add_emitter(scene, test::make_square(1), {1, 1, 1}, make_translation({1, 0.5f, -2}));
    scene.materials.back().two_sided_emission = true;
    const auto add = [&](LightKind kind, Vec3 position, Vec3 direction) {
        Light& light = scene.lights.emplace_back();
        light.kind = kind;
        light.position = position;
        light.direction = normalize(direction);
        light.intensity = {4, 4, 4};
        light.cos_inner = 0.9f;
        light.cos_outer = 0.7f;
    };
    add(LightKind::Directional, {}, {1, -2, 0});
    add(LightKind::Point, {0, 3, 2}, {0, -1, 0});
    add(LightKind::Spot, {1, 2, 3}, {-1, -2, -3});
    scene.environment = Environment{};
    scene.environment->scale = {0.1f, 0.1f, 0.1f};
    return scene;
}

} // namespace

TEST_CASE("a tree samples lights of every kind with the densities that it reports for them") {
    const test::Lights lights(every_light());
    const LightSetView& view = lights.view;
    REQUIRE(view.tree.light_count == view.triangle_count + 2);
    const float sky = ChosenByTree::pmf_of_environment(view, Vec3{});
    REQUIRE(view.triangle_count == 12);
    test::Random random(3);
    const LightContext contexts[] = {{{0, 0, 0}, {0, 1, 0}, false, kAtRest},
                                     {{-2, 1.9f, 0.3f}, normalize(Vec3{1, 1, 0}), false, kAtRest},
                                     {{1, 0.5f, -1.5f}, {0, 0, -1}, true, kAtRest},
                                     {{3, 4, 5}, normalize(Vec3{-1, -1, -1}), false, kAtRest}};
    for (const LightContext& context : contexts) {
        constexpr uint32_t kDraws = 100'000;
        std::vector<double> drawn(17), expected(17); // triangles, punctual lights, the sky, nothing
        uint32_t other = 0;
        double sum = 0;
        for (uint32_t light = 0; light < 14; ++light) {
            expected[light] = kDraws * test::as_double(ChosenByTree::pmf_of_triangle(view, context, light));
        }
        expected[14] = kDraws * test::as_double(cdf_pmf(view.choice, view.near_count)); // the directional light
        expected[15] = kDraws * test::as_double(sky);
        for (const double number : expected) sum += number;
        expected[16] = kDraws - sum;
        CHECK(expected[16] > -1);
        struct Taken {
            const LightSetView& view;
            const LightContext& context;
            uint32_t &slot, &other;
            bool triangle(uint32_t light, Vec2 b, float pmf) const {
                slot = light;
                LightSample sample;
                other += pmf == ChosenByTree::pmf_of_triangle(view, context, light) ? 0 : 1;
                if (!triangle_light_at<EmitterVariant::Plain>(view, light, pmf, context.point, b, sample)) return false;
                other += sample.pdf == pdf_light_hit<ChosenByTree>(view, light, context, sample.light_point) ? 0 : 1;
                return true;
            }
            bool punctual(uint32_t number, float pmf) const {
                slot = 12 + number;
                if (number < 2) other += pmf == ChosenByTree::pmf_of_triangle(view, context, 12 + number) ? 0 : 1;
                return true;
            }
            bool environment(float pmf, SampleBits) const {
                slot = 15;
                other += pmf == ChosenByTree::pmf_of_environment(view, context) ? 0 : 1;
                return true;
            }
        };
        for (uint32_t i = 0; i < kDraws; ++i) {
            uint32_t slot = 16;
            ChosenByTree::draw(view, context, test::random_bits(random), Taken{view, context, slot, other});
            drawn[slot] += 1;
        }
        CHECK(other == 0);
        const test::ChiSquareResult result = test::chi_square(drawn, expected);
        CHECK_MESSAGE(result.passes(4), result.describe());
    }
}

TEST_CASE("instances of an emissive mesh share a subtree if they are alike, and others keep theirs") {
    Scene scene;
    Mesh mesh = test::make_square(6);
    for (Vec3& position : mesh.positions) position += Vec3{40, 0, 0}; // far from its own origin
    const auto corner = static_cast<uint32_t>(mesh.positions.size());
    for (const float x : {0.25f, 0.5f, 0.75f}) { // a triangle without area, which has some where it is turned
        mesh.positions.push_back({40 + x, x, 0.25f * x});
        mesh.uv[0].push_back({});
    }
    mesh.indices.insert(mesh.indices.end(), {corner, corner + 1, corner + 2});
    test::add_emitter(scene, mesh, {3, 2, 1}, test::make_similarity({0, 0.6f, 0.8f}, 2.1f, 0.5f, {10, 0, 15}));
    const auto add_copy = [&](const Transform& world_from_local) -> Instance& {
        scene.instances.push_back(scene.instances.front());
        scene.instances.back().world_from_local = world_from_local;
        return scene.instances.back();
    };
    add_copy(test::make_similarity({0.6f, 0.8f, 0}, 0.8f, -1, {20, 3, 30}));
    add_copy(compose(make_translation({-30, 2, 1}), make_scale({1, 2, 3})));
    add_copy(make_translation({-40, 2, 1})).is_hidden = true;
    scene.materials.push_back(scene.materials.front());
    scene.materials.back().emission = {1, 1, 1};
    add_copy(make_translation({-40, 3, 1})).material = 1;
    const uint32_t small = test::add_emitter(scene, test::make_square(2), {1, 1, 1}, make_translation({0, 4, 0}));
    add_copy(make_translation({2, 4, 0})).mesh = scene.instances[small].mesh;
    scene.instances.back().material = scene.instances[small].material;

    const test::Lights lights(scene);
    const LightTreeData& tree = lights.data.tree->get();
    REQUIRE(lights.view.triangle_count == 4 * 73 + 2 * 8);
    CHECK(tree.instances.size() == 2);
    CHECK(tree.light_count == 4 * 72 + 2 * 8);
    CHECK(tree.nodes.size() == 2 * (2 + 2 * 72 + 2 * 8 + 72));
    const LightContext contexts[] = {{{0, 0, 0}, {0, 1, 0}, false, kAtRest},
                                     {{30, 0, 20}, {0, 0, 0}, false, kAtRest},
                                     {{-1, 5, 1}, {0, -1, 0}, true, kAtRest}};
    test::Random random(8);
    for (const LightContext& context : contexts) {
        const LightReceiver to = {context.point, context.normal};
        double sum = test::visit_tree(lights.view.tree, to, [](uint32_t, double) {});
        for (uint32_t light = 0; light < lights.view.triangle_count; ++light)
            sum += test::as_double(pmf_in_tree(lights.view.tree, to, light));
        CHECK(sum == doctest::Approx(1).epsilon(1e-5));
        uint32_t wrong = 0, shared = 0;
        for (int i = 0; i < 2000; ++i) {
            const uint64_t number = uint64_t{random.bits()} << 31;
            const LightTreeDraw draw = draw_from_tree(lights.view.tree, to, number, uint64_t{1} << 63);
            if (draw.light == LightTreeDraw::kNoLeaf) continue;
            wrong += draw.pmf == pmf_in_tree(lights.view.tree, to, draw.light) ? 0 : 1;
            shared += (lights.view.tree.leaf_of_light[draw.light] & LightTreeNode::kLeaf) != 0 ? 1 : 0;
        }
        CHECK(wrong == 0);
        CHECK(shared > 0);
    }
}

TEST_CASE("a draw on the floor of many-lights has a relative variance of at most 0.5") {
    Messages messages;
    const Scene scene = read_scene("many-lights", {}, messages);
    const test::Lights lights(scene);
    const LightSetView& view = lights.view;
    REQUIRE(view.tree.light_count == 10'000);
    test::Random random(5);
    double by_tree = 0, by_power = 0;
    bool are_two_sided = true;
    constexpr int kPoints = 60;
    for (int k = 0; k < kPoints; ++k) {
        const float x = random.within(-8, 8);
        const LightReceiver to = {{x, 0.001f, random.within(-12, 12)}, {0, 1, 0}};
        double sum = 0, tree = 0, power = 0, found = 0;
        std::vector<double> arriving(view.triangle_count);
        for (uint32_t i = 0; i < view.triangle_count; ++i) {
            const EmissiveTriangle& triangle = view.triangles[i];
            const float emission = luminance(view.emissions[triangle.material].emission);
            const test::SmallLight front = {triangle.a, triangle.ab, triangle.ac, emission};
            const test::SmallLight back = {triangle.a, triangle.ac, triangle.ab, emission};
            are_two_sided = are_two_sided && triangle.is_two_sided != 0;
            arriving[i] = test::light_at(front, to) + test::light_at(back, to);
            sum += arriving[i];
            power += arriving[i] * arriving[i] / test::as_double(triangle.pmf);
        }
        test::visit_tree(view.tree, to, [&](uint32_t i, double p) {
            tree += arriving[i] * arriving[i] / p;
            found += arriving[i];
        });
        CHECK(found == doctest::Approx(sum).epsilon(1e-9));
        by_tree += tree / (sum * sum) - 1, by_power += power / (sum * sum) - 1;
    }
    MESSAGE("relative variance by tree ", by_tree / kPoints, ", by power ", by_power / kPoints);
    CHECK(are_two_sided);
    CHECK(by_tree / kPoints <= 0.5);
    CHECK(by_power / kPoints > 3);
}

TEST_CASE("a tree selects a narrow spot as often as a point light of its intensity, and one face as often as two") {
    Scene scene;
    const auto add = [&](LightKind kind, float x) {
        Light& light = scene.lights.emplace_back();
        light.kind = kind;
        light.position = {x, 4, 0};
        light.direction = {0, -1, 0};
        light.intensity = {5, 5, 5};
        light.cos_inner = 0.9999f, light.cos_outer = 0.999f; // its flux is 1/1800 of the point light's
    };
    add(LightKind::Point, 3);
    add(LightKind::Spot, 0);
    const test::Lights lights(scene);
    const LightReceiver below_both = {{0, 0, 0}, {0, 0, 0}};
    const uint32_t spot = lights.view.punctual[0].kind == LightKind::Spot ? 0 : 1;
    const float pmf = pmf_in_tree(lights.view.tree, below_both, spot);
    CHECK(pmf == doctest::Approx(25.0 / (25 + 16)).epsilon(0.01)); // by the squared distances alone

    Scene faces;
    for (const bool has_two : {false, true}) {
        Transform at;
        at.translation = {has_two ? 2.0f : -2.0f, 4, 0};
        test::add_emitter(faces, test::make_square(1), {1, 1, 1}, at);
        faces.materials.back().two_sided_emission = has_two;
    }
    const test::Lights of_faces(faces);
    double of_two = 0;
    for (uint32_t i = 0; i < 4; ++i) {
        if (of_faces.view.triangles[i].is_two_sided != 0)
            of_two += test::as_double(pmf_in_tree(of_faces.view.tree, below_both, i));
    }
    CHECK(of_two == doctest::Approx(0.5).epsilon(0.01));
}
