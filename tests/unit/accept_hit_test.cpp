#include <cmath>
#include <cstdint>
#include <vector>

#include <doctest/doctest.h>

#include "device_scene/accept_hit.h"
#include "device_scene/scene_on_device.h"
#include "math/portable_math.h"
#include "render/prepare_scene.h"
#include "tests/support/random.h"
#include "trace/intersect/intersect_triangle.h"

using namespace pertev;

namespace {

enum InstanceIndex : uint32_t { kSolid, kMasked, kBlended, kTinted, kInstances };

/// Four squares of two triangles: opaque; cut out by a texture that is opaque on the left; blended at 0.3; blended at
/// 0.8 with vertex colours of alpha 1 on the left and 0 on the right.
struct AlphaScene {
    AlphaScene() : device(queue, prepare()) {}

    PreparedScene prepare() {
        Mesh square;
        square.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
        square.uv[0] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
        square.indices = {0, 1, 2, 0, 2, 3};
        for (int i = 0; i < 4; ++i) scene.meshes.push_back(square);
        scene.meshes[kTinted].colors = {{1, 1, 1, 1}, {1, 1, 1, 0}, {1, 1, 1, 0}, {1, 1, 1, 1}};
        TextureImage image;
        image.rgba8 = {2, 1, {255, 255, 255, 255, 255, 255, 255, 0}};
        scene.images.push_back(image);
        TextureRef half_clear{.image = 0};
        scene.materials.push_back({{.alpha = 0.1f}, "solid"}); // opaque: alpha is ignored
        scene.materials.push_back(
            {{.alpha_mode = AlphaMode::Mask, .alpha_cutoff = 0.5f, .base_color_texture = half_clear}, "masked"});
        scene.materials.push_back({{.alpha_mode = AlphaMode::Blend, .alpha = 0.3f}, "blended"});
        scene.materials.push_back({{.alpha_mode = AlphaMode::Blend, .alpha = 0.8f}, "tinted"});
        for (uint32_t i = 0; i < kInstances; ++i) scene.instances.push_back({"", i, i, {}});
        Messages messages;
        return prepare_scene(scene, {}, messages);
    }

    /// Returns the share of `count` paths whose ray stops at barycentrics (u, v) of the instance's first triangle.
    double stopped(uint32_t instance, float u, float v, uint32_t count = 20'000) const {
        uint32_t hits = 0;
        for (uint32_t key = 0; key < count; ++key)
            hits += AcceptHit{device.view(), {}, {}, key * 7919}(instance, 0, u, v);
        return static_cast<double>(hits) / count;
    }

    Scene scene;
    Queue queue = Queue::make_cpu();
    SceneOnDevice device;
};

} // namespace

TEST_CASE("a ray ignores the triangle that it leaves and its target, and hits every other one") {
    const AlphaScene test;
    const AcceptHit accept{test.device.view(), {kSolid, 1}, {kMasked, 0}, 5};
    CHECK_FALSE(accept(kSolid, 1, 0.2f, 0.2f));
    CHECK(accept(kSolid, 0, 0.2f, 0.2f));
    CHECK_FALSE(accept(kMasked, 0, 0.0f, 0.9f));
    CHECK(accept(kMasked, 1, 0.0f, 0.9f));
    const AcceptHit from_nowhere{test.device.view(), {}, {}, 5};
    CHECK(from_nowhere(kSolid, 1, 0.2f, 0.2f));
}

TEST_CASE("opaque surfaces stop every ray, whatever their alpha is") {
    const AlphaScene test;
    CHECK(test.stopped(kSolid, 0.1f, 0.1f) == 1);
}

TEST_CASE("a cut-out stops rays where its texture's alpha reaches the cutoff") {
    const AlphaScene test; // first triangle: u is the weight of (1, 0), v of (1, 1)
    CHECK(test.stopped(kMasked, 0.1f, 0.1f) == 1);
    CHECK(test.stopped(kMasked, 0.5f, 0.3f) == 0);
}

TEST_CASE("a blended surface stops the share of paths that equals its alpha, including vertex colours") {
    const AlphaScene test;
    const double deviation = std::sqrt(0.25 / 20'000);
    CHECK(std::abs(test.stopped(kBlended, 0.3f, 0.3f) - 0.3) < 4 * deviation);
    CHECK(std::abs(test.stopped(kTinted, 0.2f, 0.2f) - 0.8 * 0.6) < 4 * deviation);
    CHECK(test.stopped(kTinted, 0.5f, 0.5f) == 0);
}

TEST_CASE("the random decision at a blended surface is a function of path, instance and primitive") {
    const AlphaScene test;
    uint32_t other_primitive = 0, other_place = 0;
    for (uint32_t key = 0; key < 1000; ++key) {
        const AcceptHit accept{test.device.view(), {}, {}, key};
        const bool first = accept(kBlended, 0, 0.3f, 0.3f);
        other_primitive += first != accept(kBlended, 1, 0.3f, 0.3f);
        other_place += first != accept(kBlended, 0, 0.1f, 0.6f); // has the same alpha, but another random decision
    }
    CHECK(other_primitive > 300);
    CHECK(other_place == 0);
}

namespace {

/// A scene of one instance.
struct OneSurface {
    OneSurface(const Mesh& mesh, const Material& material, const std::vector<TextureImage>& images = {})
        : device(queue, prepare(mesh, material, images)) {}

    PreparedScene prepare(const Mesh& mesh, const Material& material, const std::vector<TextureImage>& images) {
        scene.meshes = {mesh};
        scene.materials = {material};
        scene.images = images;
        scene.instances.push_back({"", 0, 0, {}});
        Messages messages;
        return prepare_scene(scene, {}, messages);
    }
    bool stops(uint32_t primitive, float u, float v, uint32_t key = 0) const {
        return AcceptHit{device.view(), {}, {}, key}(0, primitive, u, v);
    }

    Scene scene;
    Queue queue = Queue::make_cpu();
    SceneOnDevice device;
};

Mesh triangle_of_alpha(float a, float b, float c) {
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.colors = {{1, 1, 1, a}, {1, 1, 1, b}, {1, 1, 1, c}};
    mesh.indices = {0, 1, 2};
    return mesh;
}

/// Returns the share of the triangle where the surface stops rays.
double share_stopped(const OneSurface& surface, uint32_t places = 20'000) {
    test::Random random(3);
    uint32_t stopped = 0;
    for (uint32_t i = 0; i < places; ++i) {
        const float u = random.unit(), v = random.unit() * (1 - u);
        stopped += surface.stops(0, u, v, i);
    }
    return static_cast<double>(stopped) / places;
}

} // namespace

TEST_CASE("a cut-out stops rays where the alpha of vertices equals the cutoff") {
    for (const float alpha : {1.0f, 0.5f, 0.3f, 1.0f / 3}) {
        const Material masked = {{.alpha_mode = AlphaMode::Mask, .alpha_cutoff = alpha}};
        CAPTURE(alpha);
        CHECK(share_stopped({triangle_of_alpha(alpha, alpha, alpha), masked}) == 1);
        // The next smaller 16-bit alpha is below the cutoff.
        const float less = alpha - 1.0f / 65535;
        CHECK(share_stopped({triangle_of_alpha(less, less, less), masked}) == 0);
    }
    // The rounded products 0.7 x 0.7 and 0.9 x 0.9 are less than the cutoff.
    CHECK(0.7f * 0.7f < 0.49f);
    CHECK(share_stopped({triangle_of_alpha(0.7f, 0.7f, 0.7f),
                         {{.alpha_mode = AlphaMode::Mask, .alpha = 0.7f, .alpha_cutoff = 0.49f}}}) == 1);
    CHECK(0.9f * 0.9f < 0.81f);
    CHECK(share_stopped({triangle_of_alpha(0.9f, 0.9f, 0.9f),
                         {{.alpha_mode = AlphaMode::Mask, .alpha = 0.9f, .alpha_cutoff = 0.81f}}}) == 1);
    // A cutoff that is barely above 1 hides everything.
    CHECK(share_stopped({triangle_of_alpha(1, 1, 1), {{.alpha_mode = AlphaMode::Mask, .alpha_cutoff = 1.0000001f}}}) ==
          0);
}

TEST_CASE("a cut-out stops rays where the alpha of texels equals the cutoff, for all 256 values") {
    for (uint32_t value = 1; value < 256; ++value) {
        Mesh mesh = triangle_of_alpha(1, 1, 1);
        mesh.colors.clear();
        mesh.uv[0] = {{0, 0}, {1, 0}, {0, 1}};
        TextureImage image;
        image.rgba8 = {1, 1, {255, 255, 255, static_cast<uint8_t>(value)}};
        const Material masked = {{.alpha_mode = AlphaMode::Mask,
                                  .alpha_cutoff = static_cast<float>(value / 255.0),
                                  .base_color_texture = {.image = 0}}};
        CAPTURE(value);
        CHECK(share_stopped({mesh, masked, {image}}, 20) == 1);
    }
}

TEST_CASE("a blended surface whose vertices have alpha 1 stops every ray") {
    CHECK(share_stopped({triangle_of_alpha(1, 1, 1), {{.alpha_mode = AlphaMode::Blend}}}, 1'000'000) == 1);
}

namespace {

/// A fan of triangles around a centre, each with its own vertices, as exporters write flat normals.
Mesh fan(uint32_t sides, test::Random& random) {
    std::vector<Vec3> rim;
    for (uint32_t i = 0; i < sides; ++i) {
        const float angle = kTwoPi * static_cast<float>(i) / static_cast<float>(sides), size = 1 + random.unit();
        rim.push_back({size * cos(angle), size * sin(angle), random.unit() - 0.5f});
    }
    Mesh mesh;
    for (uint32_t i = 0; i < sides; ++i) {
        const Vec3 corners[3] = {{0, i % 2 == 0 ? 0.0f : -0.0f, 0}, rim[i], rim[(i + 1) % sides]};
        for (uint32_t k = 0; k < 3; ++k) { // the triangles begin with different corners
            mesh.indices.push_back(static_cast<uint32_t>(mesh.positions.size()));
            mesh.positions.push_back(corners[(i + k) % 3]);
        }
    }
    return mesh;
}

/// Returns the triangles of the mesh that a ray along -z hits at (x, y), with the position on each.
struct Met {
    uint32_t primitive;
    float u, v;
};
std::vector<Met> triangles_met(const Mesh& mesh, float x, float y) {
    std::vector<Met> met;
    const Vec3 direction = {0, 0, -1};
    const RayShear shear = make_ray_shear(direction);
    for (uint32_t i = 0; i < mesh.indices.size() / 3; ++i) {
        const auto corner = [&](uint32_t k) { return mesh.positions[mesh.indices[3 * i + k]]; };
        TriangleHit hit;
        if (intersect_triangle({x, y, 4}, shear, 0, kInfinity, corner(0), corner(1), corner(2), hit))
            met.push_back({i, hit.u, hit.v});
    }
    return met;
}

} // namespace

TEST_CASE("triangles of a blended surface that a ray meets on a common edge or corner count once") {
    test::Random random(11);
    uint32_t on_edges = 0, at_corners = 0;
    for (uint32_t round = 0; round < 40; ++round) {
        const uint32_t sides = 3 + round % 5;
        const Mesh mesh = fan(sides, random);
        const OneSurface pane(mesh, {{.alpha_mode = AlphaMode::Blend, .alpha = 0.25f}});
        const auto stop_alike = [&](const std::vector<Met>& met) {
            uint32_t stopped = 0;
            for (uint32_t key = 0; key < 2000; ++key) {
                const bool first = pane.stops(met[0].primitive, met[0].u, met[0].v, key * 7919);
                for (const Met& m : met) CHECK(pane.stops(m.primitive, m.u, m.v, key * 7919) == first);
                stopped += first;
            }
            CHECK(std::abs(stopped / 2000.0 - 0.25) < 5 * std::sqrt(0.25 * 0.75 / 2000));
        };
        const std::vector<Met> middle = triangles_met(mesh, 0, 0);
        REQUIRE(middle.size() == sides);
        ++at_corners;
        stop_alike(middle);
        // The point halfway to a vertex of the rim lies exactly on the edge to that vertex.
        for (uint32_t i = 0; i < mesh.positions.size(); ++i) {
            const Vec3 half = 0.5f * mesh.positions[i];
            const std::vector<Met> met = triangles_met(mesh, half.x, half.y);
            if (met.size() != 2) continue;
            ++on_edges;
            stop_alike(met);
        }
    }
    CHECK(at_corners == 40);
    CHECK(on_edges > 100);
}

TEST_CASE("each edge of a blended surface has its own random decision") {
    test::Random random(12);
    const Mesh mesh = fan(6, random);
    const OneSurface pane(mesh, {{.alpha_mode = AlphaMode::Blend, .alpha = 0.5f}});
    const OneSurface other_place(
        [&] {
            Mesh moved = mesh;
            for (Vec3& p : moved.positions) p.x += 1;
            return moved;
        }(),
        {{.alpha_mode = AlphaMode::Blend, .alpha = 0.5f}});
    uint32_t of_edges = 0, of_places = 0, of_inside = 0;
    for (uint32_t key = 0; key < 1000; ++key) {
        const bool first = pane.stops(0, 0, 0.5f, key);
        of_edges += first != pane.stops(0, 0.5f, 0, key);
        of_places += first != other_place.stops(0, 0, 0.5f, key);
        of_inside += first != pane.stops(0, 0.1f, 0.5f, key);
    }
    for (const uint32_t differing : {of_edges, of_places, of_inside}) CHECK(std::abs(differing / 1000.0 - 0.5) < 0.07);
}
