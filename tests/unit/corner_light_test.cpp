// Corners of patches share their light if they have the same position, at any scale and distance, and only then.

#include <doctest/doctest.h>

#include <cmath>

#include "radiosity/corner_light.h"
#include "tests/support/cpu_seconds.h"
#include "tests/support/radiosity_scenes.h"

using namespace pertev;

namespace {

/// `cells` x `cells` squares of two triangles each, `side` metres together, about `centre`, in the plane of x and z.
Mesh grid_at(Vec3 centre, float side, uint32_t cells) {
    Mesh mesh;
    for (uint32_t z = 0; z <= cells; ++z) {
        for (uint32_t x = 0; x <= cells; ++x) {
            const Vec2 at = {static_cast<float>(x) / static_cast<float>(cells) - 0.5f,
                             static_cast<float>(z) / static_cast<float>(cells) - 0.5f};
            mesh.positions.push_back(centre + side * Vec3{at.x, 0, at.y});
        }
    }
    for (uint32_t z = 0; z < cells; ++z) {
        for (uint32_t x = 0; x < cells; ++x) {
            const uint32_t a = z * (cells + 1) + x, b = a + 1, c = a + cells + 1, d = c + 1;
            for (const uint32_t i : {a, c, b, b, c, d}) mesh.indices.push_back(i);
        }
    }
    return mesh;
}

std::vector<PatchLight> lights_of(const test::PatchedScene& patched, const std::vector<Rgb>& irradiance) {
    return light_corners(patched.solved.view(), patched.tree, irradiance);
}

/// A cone of `count` triangles that share its tip.
Mesh cone_of(uint32_t count) {
    Mesh mesh;
    mesh.positions.push_back({0, 1, 0});
    for (uint32_t i = 0; i < count; ++i) {
        const double angle = 2 * 3.14159265358979 * i / count;
        mesh.positions.push_back({static_cast<float>(std::cos(angle)), 0, static_cast<float>(std::sin(angle))});
        const uint32_t next = i + 1 == count ? 1 : i + 2;
        for (const uint32_t k : {0u, next, i + 1}) mesh.indices.push_back(k);
    }
    return mesh;
}

} // namespace

TEST_CASE("a small object keeps its own light in a scene a hundred thousand times larger") {
    Scene scene;
    test::add(scene, test::floor_at(0, 1000), test::white(0.5f));
    test::add(scene, grid_at({300, 1, 300}, 0.01f, 8), test::white(0.5f));
    const test::PatchedScene patched(std::move(scene), 1e9f);
    const auto x_of = [&](Vec3 p) { return (p.x - 300) / 0.01f; }; // [-0.5, 0.5]
    std::vector<Rgb> irradiance;
    for (const Patch& patch : patched.tree.patches) {
        const WorldTriangle triangle = world_triangle(patched.solved.view(), patch, patch.corners.middle());
        const Vec2 middle = patch.corners.middle();
        irradiance.push_back(patch.instance == 1 ? grey(1 + x_of(triangle.at(middle.x, middle.y))) : grey(100));
    }
    const std::vector<PatchLight> lights = lights_of(patched, irradiance);
    int compared = 0;
    for (std::size_t i = 0; i < lights.size(); ++i) {
        const Patch& patch = patched.tree.patches[i];
        if (patch.instance != 1) continue;
        const WorldTriangle triangle = world_triangle(patched.solved.view(), patch, patch.corners.middle());
        for (int k = 0; k < 3; ++k) {
            const Vec2 at = patch.corners.at[k];
            const float x = x_of(triangle.at(at.x, at.y));
            CHECK(std::abs(lights[i].corner[k].r - (1 + x)) <
                  0.15f); // the difference is at the rim of one side only, and at most a cell wide
            ++compared;
        }
    }
    CHECK(compared == 2 * 128 * 3);
}

TEST_CASE("neighbours separated only by rounding share the light at their corners") {
    for (int turn = 0; turn < 8; ++turn) {
        Scene scene;
        const Mesh tile = grid_at({0.5f, 0, 0.5f}, 1, 1);
        for (int i = 0; i < 2; ++i) test::add(scene, tile, test::white(0.5f));
        const Transform turned = compose(make_rotation(0.5f, 0.1f, 0.7f, 0.5f), make_rotation(0.1f, 0.7f, 0.1f, 0.7f));
        const Transform on =
            make_translation({0.73f - 0.1f * static_cast<float>(turn), -0.21f, 0.37f * static_cast<float>(turn)});
        scene.instances[0].world_from_local = compose(on, turned);
        scene.instances[1].world_from_local = compose(scene.instances[0].world_from_local, make_translation({1, 0, 0}));
        const test::PatchedScene patched(std::move(scene), 0.4f);
        const Transform& placed = patched.solved.view().instances[0].world_from_local;
        std::vector<Rgb> irradiance;
        for (const Patch& patch : patched.tree.patches) irradiance.push_back(grey(patch.instance == 0 ? 1.0f : 3.0f));
        const std::vector<PatchLight> lights = lights_of(patched, irradiance);
        int shared = 0;
        for (std::size_t i = 0; i < lights.size(); ++i) {
            const Patch& patch = patched.tree.patches[i];
            const WorldTriangle triangle = world_triangle(patched.solved.view(), patch, patch.corners.middle());
            for (int k = 0; k < 3; ++k) {
                const Vec3 at = triangle.at(patch.corners.at[k].x, patch.corners.at[k].y) - placed.translation;
                const float along = dot(at, transform_vector(placed, {1, 0, 0}));
                const bool is_between = std::abs(along - 1) < 1e-4f;
                CHECK((lights[i].corner[k].r > 1.2f && lights[i].corner[k].r < 2.8f) == is_between);
                shared += is_between ? 1 : 0;
            }
        }
        CHECK(shared > 20);
    }
}

TEST_CASE("corners are found quickly where tens of thousands of triangles meet") {
    for (const bool is_cone : {true, false}) {
        Scene scene;
        Mesh mesh = is_cone ? cone_of(60000) : grid_at({0, 0, 0}, 1, 1);
        if (!is_cone) { // one triangle lies on the other
            for (int i = 0; i < 30000; ++i) {
                for (int k = 0; k < 6; ++k) mesh.indices.push_back(mesh.indices[static_cast<std::size_t>(k)]);
            }
        }
        test::add(scene, std::move(mesh), test::white(0.5f));
        const test::PatchedScene patched(std::move(scene), 1e9f);
        const std::vector<Rgb> irradiance(patched.tree.patches.size(), grey(2));
        const double before = test::cpu_seconds();
        const std::vector<PatchLight> lights = lights_of(patched, irradiance);
        CHECK(test::cpu_seconds() - before < test::allowed_seconds(3));
        for (const PatchLight& light : lights) CHECK(std::abs(light.corner[0].g - 2) < 1e-5f);
    }
}
