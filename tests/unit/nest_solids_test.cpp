// Which solids lie in each other, and their ranks (device_scene/nest_solids.h).

#include <cmath>
#include <tuple>
#include <vector>

#include <doctest/doctest.h>

#include "device_scene/close_gaps.h"
#include "device_scene/line_crossings.h"
#include "device_scene/nest_solids.h"
#include "session/check_integrator.h"
#include "tests/support/meshes.h"
#include "tests/support/random.h"
#include "tests/support/solid_scenes.h"

using namespace pertev;

namespace {

std::vector<uint16_t> ranks_of(const Scene& scene) { return NestedSolids(scene, {}).ranks(); }
using Ranks = std::vector<uint16_t>;

} // namespace

TEST_CASE("lines from points in a mesh leave it once more than they enter it, also where triangles are long") {
    test::TriangleMesh ball = test::make_sphere(4, {1, 2, 3}, 2); // 5,120 triangles
    test::TriangleMesh rod;                                       // 1,600 triangles, most of them 1 to 2,500
    constexpr uint32_t kSides = 400;
    rod.positions = {{0, -50, 0}, {0, 50, 0}};
    for (uint32_t i = 0; i < kSides; ++i) {
        const float angle = 2 * kPi * static_cast<float>(i) / kSides;
        for (const float y : {-50.0f, 50.0f}) rod.positions.push_back({2 * std::cos(angle), y, 2 * std::sin(angle)});
        const uint32_t a = 2 + 2 * i, b = 2 + 2 * ((i + 1) % kSides);
        for (const uint32_t corner : {a, a + 1, b, b, a + 1, b + 1, 0u, a, b, 1u, b + 1, a + 1})
            rod.indices.push_back(corner);
    }
    test::Random random(5);
    for (const auto& [mesh, centre, height] : {std::tuple(&ball, Vec3{1, 2, 3}, 0.0f), {&rod, Vec3{0, 0, 0}, 50.0f}}) {
        const DoubleVec3 ways[] = {{0.3, 0.2, 0.9}, {0.1, -0.9, 0.2}, {1, 0, 0}};
        std::vector<LineCrossings> lines;
        for (const DoubleVec3& way : ways) lines.emplace_back(mesh->positions, mesh->indices, way);
        int inside = 0;
        for (int k = 0; k < 2000; ++k) {
            const Vec3 off = random.point(-2.5f, 2.5f);
            const Vec3 across = height > 0 ? Vec3{off.x, 0, off.z} : off;
            if (std::abs(length(across) - 2) < 0.01f) continue; // near the surface
            const bool is_inside = length(across) < 2;
            inside += is_inside ? 1 : 0;
            const DoubleVec3 from = to_double(centre + Vec3{off.x, height > 0 ? 19 * off.y : off.y, off.z});
            for (const LineCrossings& line : lines)
                CHECK(std::abs(line.count(mesh->positions, mesh->indices, from)) == (is_inside ? 1 : 0));
        }
        CHECK(inside > 200);
    }
}

TEST_CASE("a list of solids holds the four greatest ranks, each once") {
    InteriorList list;
    CHECK(list.top() == 0);
    list = list.with(3).with(9).with(1);
    CHECK(list.top() == 9);
    CHECK(list.with(3).ranks == list.ranks);
    CHECK(list.without(5).ranks == list.ranks);
    CHECK(list.without(9).top() == 3);
    CHECK(list.without(3).top() == 9);
    CHECK(!list.without(3).has(3));
    // 1 had no room, and is there no more.
    CHECK(list.with(0xffff).with(2).without(0xffff).ranks == InteriorList{}.with(2).with(3).with(9).ranks);
    CHECK(InteriorList::of_words(list.words()).ranks == list.ranks);
    CHECK(list.without(1).without(3).without(9).ranks == 0);
}

TEST_CASE("of solids in each other the innermost has the greatest rank, of equal ones the first") {
    Scene scene;
    test::add(scene, test::box({0, 0, 0}, {1, 1, 1}), test::glass(1.5f));
    CHECK(ranks_of(scene).empty());
    test::add(scene, test::box({0, 0, 0}, {0.5f, 0.5f, 0.5f}), test::glass(1));
    CHECK(ranks_of(scene) == Ranks{1, 2});
    test::add(scene, test::box({0.1f, 0, 0}, {0.2f, 0.2f, 0.2f}), test::glass(1.3f));
    CHECK(ranks_of(scene) == Ranks{1, 2, 3});
    CHECK(NestedSolids(scene, {}).instances() == std::vector<uint32_t>{0, 0, 1, 2});
    test::add(scene, test::box({5, 0, 0}, {1, 1, 1}), test::glass(1.5f)); // nothing is near it
    test::add(scene, test::box({0, 1, 0}, {0.9f, 0.5f, 0.9f}), test::glass(1.2f));
    CHECK(ranks_of(scene) == Ranks{2, 3, 4, 0, 1}); // the last one overlaps the first and is in none
    scene.materials[4].priority = 1;
    CHECK(ranks_of(scene) == Ranks{1, 2, 3, 0, 4});
    scene.instances[2].world_from_local = make_translation({0, 20, 0});
    CHECK(ranks_of(scene) == Ranks{1, 2, 0, 0, 3});
}

TEST_CASE(
    "of a clear boundary and glass in equally many solids the glass has the greater rank, also an open boundary") {
    Scene scene;
    Material fog;
    fog.medium.sigma_s = {1, 1, 1};
    fog.make_clear_boundary();
    test::add(scene, test::box({0, 0, 0}, {1, 1, 1}), fog);
    test::add(scene, test::box({1, 0, 0}, {0.5f, 0.5f, 0.5f}), test::glass(1.5f)); // straddles it
    CHECK(ranks_of(scene) == Ranks{1, 2});
    CHECK(NestedSolids(scene, {}).at({0.75f, 0, 0}).top() == 2);
    CHECK_FALSE(NestedSolids(scene, {}).is_nested());
    Mesh open = test::box({-0.5f, 0, 0}, {0.2f, 0.2f, 0.2f});
    open.indices.resize(open.indices.size() - 3);
    test::add(scene, open, fog);
    CHECK(ranks_of(scene) == Ranks{1, 2, 3});
    scene.instances[2].is_background = true;
    CHECK(ranks_of(scene) == Ranks{1, 2, 0});
    scene.materials[1].medium.sigma_s = {1, 1, 1};
    for (int i = 0; i < 3; ++i)
        test::add(scene, test::box({-0.5f, 0, 0}, (0.4f - 0.1f * float(i)) * Vec3{1, 1, 1}), fog);
    CHECK(ranks_of(scene) == Ranks{1, 2, 0, 3, 4, 5});
}

TEST_CASE("only closed meshes of glass that light enters are solids, and boxes that touch do not overlap") {
    Scene scene;
    test::add(scene, test::box({0, 0, 0}, {1, 1, 1}), test::glass(1.5f));
    Material pane = test::glass(1.5f);
    pane.kind = MaterialKind::MetallicRoughness;
    pane.transmission_weight = 1;
    test::add(scene, test::box({0, 0, 0}, {0.5f, 0.5f, 0.5f}), pane); // a thin wall
    test::add(scene, test::box({0, 0, 0}, {0.4f, 0.4f, 0.4f}), test::white());
    Mesh open = test::box({0, 0, 0}, {0.3f, 0.3f, 0.3f});
    CHECK(is_closed(open));
    open.indices.resize(open.indices.size() - 3);
    CHECK(!is_closed(open));
    test::add(scene, open, test::glass(1.5f));
    test::add(scene, test::box({2, 0, 0}, {1, 1, 1}), test::glass(1.5f));
    CHECK(ranks_of(scene).empty());
    scene.materials[1].thin_walled = false;
    CHECK(ranks_of(scene) == Ranks{1, 2, 0, 0, 0});
    scene.instances[1].is_hidden = true;
    CHECK(ranks_of(scene).empty());
}

TEST_CASE("a triangle without its neighbour's direction, or a corner at another place, opens a mesh") {
    Mesh mesh = test::box({0, 0, 0}, {1, 1, 1});
    std::swap(mesh.indices[1], mesh.indices[2]);
    CHECK(!is_closed(mesh));
    std::swap(mesh.indices[1], mesh.indices[2]);
    mesh.positions.push_back(mesh.positions[mesh.indices[0]]); // split, as for texture coordinates
    mesh.indices[0] = static_cast<uint32_t>(mesh.positions.size() - 1);
    CHECK(is_closed(mesh));
    mesh.positions.back().x += 0.1f;
    CHECK(!is_closed(mesh));
}

TEST_CASE("the solids at a point are those that hold it, also in a world that was moved") {
    Scene scene;
    test::add(scene, test::ball({0, 0, 0}, 1), test::glass(1.5f));
    test::add(scene, test::ball({0, 0, 0}, 0.5f), test::glass(1));
    scene.instances[1].world_from_local = make_translation({0.25f, 0, 0});
    const Vec3 centre = {100, 0, -7};
    for (Instance& instance : scene.instances) instance.world_from_local.translation += centre;
    const NestedSolids nested(scene, centre);
    CHECK(nested.is_nested());
    CHECK(nested.at({0.25f, 0, 0}).ranks == InteriorList{}.with(1).with(2).ranks);
    CHECK(nested.at({-0.5f, 0, 0}).ranks == InteriorList{}.with(1).ranks);
    CHECK(nested.at({0, 0, 2}).ranks == 0);
    CHECK(nested.at({0.99f, 0.99f, 0}).ranks == 0); // in the box alone
}

TEST_CASE("a solid that touches an earlier one grows into it where it is near, and no farther") {
    Scene scene;
    test::add(scene, test::box({0, 0, 0}, {1, 1, 1}), test::glass(1.5f));
    test::add(scene, test::box({2.00005f, 0, 0}, {1, 1, 1}), test::glass(1.33f)); // a gap of 0.25e-4 of its size
    test::add(scene, test::box({0, 0, 4}, {1, 1, 1}), test::glass(1.33f));        // nothing is near it
    const Scene before = scene;
    CHECK(NestedSolids(scene, {}).is_empty());
    CHECK(close_gaps(scene) == 1);
    CHECK(NestedSolids(scene, {}).ranks() == Ranks{2, 1, 0});
    CHECK(scene.meshes[0].positions == before.meshes[0].positions);
    CHECK(scene.meshes[2].positions == before.meshes[2].positions);
    for (std::size_t i = 0; i < 8; ++i) {
        const Vec3 moved = scene.meshes[1].positions[i] - before.meshes[1].positions[i];
        CHECK(length(moved) == doctest::Approx(before.meshes[1].positions[i].x < 2 ? 4e-4 : 0).epsilon(0.05));
        CHECK(moved.x <= 0);
    }
    CHECK(is_closed(scene.meshes[1]));
    scene = before;
    scene.meshes[1] = test::box({2.001f, 0, 0}, {1, 1, 1}); // a gap of 5e-4
    CHECK(close_gaps(scene) == 0);
    // A corner in the box of a slanted face, but 1e-3 in front of it, which is 50 times what touches.
    Scene slanted;
    test::add(slanted, test::box({0, 0, 0}, {1, 1, 1}), test::glass(1.5f));
    test::add(slanted, test::box({0.807814f, 0.807814f, 0}, {0.1f, 0.1f, 0.1f}), test::glass(1.33f));
    for (Vec3& p : slanted.meshes[0].positions) p = {0.70710678f * (p.x - p.y), 0.70710678f * (p.x + p.y), p.z};
    CHECK(close_gaps(slanted) == 0);
    slanted.instances[1].world_from_local = make_translation({-0.000703f, -0.000703f, 0}); // a gap of 6e-6
    CHECK(close_gaps(slanted) == 1);
    // An instance of a mesh that others have gets one of its own.
    scene = before;
    scene.instances[2].mesh = 1;
    scene.instances[2].world_from_local = make_translation({0, 0, 5});
    CHECK(close_gaps(scene) == 1);
    CHECK(scene.meshes.size() == 4);
    CHECK(scene.instances[1].mesh == 3);
    CHECK(scene.meshes[1].positions == before.meshes[1].positions);
}

TEST_CASE("integrators that take each solid as in a vacuum say so where solids lie in each other") {
    const auto left_out = [](const Scene& scene, IntegratorKind integrator) {
        RenderSettings settings;
        settings.integrator = integrator;
        Messages messages;
        check_light(settings, scene, messages);
        return messages.left_out().size();
    };
    Scene scene = test::under_sky();
    test::add(scene, test::ball({0, 0, 0}, 1), test::glass(1.5f));
    test::add(scene, test::ball({1.2f, 1.2f, 1.2f}, 1), test::glass(1.5f)); // boxes overlap, balls do not
    CHECK(left_out(scene, IntegratorKind::Bidirectional) == 0);
    Material fog;
    fog.make_clear_boundary();
    test::add(scene, test::box({0, 0, 0}, {3, 3, 3}), fog);
    CHECK(left_out(scene, IntegratorKind::Bidirectional) == 0);
    test::add(scene, test::ball({0, 0, 0}, 0.5f), test::glass(1.3f));
    for (const IntegratorKind integrator : {IntegratorKind::Bidirectional, IntegratorKind::Light,
                                            IntegratorKind::PhotonMap, IntegratorKind::IrradianceCache}) {
        CHECK(left_out(scene, integrator) == 1);
    }
    CHECK(left_out(scene, IntegratorKind::Path) == 0);
    CHECK(left_out(scene, IntegratorKind::Whitted) == 0);
}
