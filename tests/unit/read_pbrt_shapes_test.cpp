#include <doctest/doctest.h>

#include <cmath>

#include "formats/read_scene.h"
#include "formats/shapes/bilinear_patches.h"
#include "formats/shapes/loop_subdivision.h"
#include "formats/shapes/quadrics.h"
#include "math/portable_math.h"
#include "tests/support/options.h"
#include "tests/support/write_text.h"

namespace fs = std::filesystem;
using namespace pertev;

namespace {

Scene load_shapes(const std::string& text) {
    Messages messages;
    Scene scene =
        read_scene(test::write_text(test::scratch_folder() / "shapes.pbrt", "WorldBegin\n" + text), {}, messages);
    CHECK(messages.left_out() == std::vector<std::string>{});
    return scene;
}

float area_of(const Mesh& mesh) {
    float sum = 0;
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
        const Vec3 a = mesh.positions[mesh.indices[i]];
        sum += 0.5f * length(cross(mesh.positions[mesh.indices[i + 1]] - a, mesh.positions[mesh.indices[i + 2]] - a));
    }
    return sum;
}

/// Tests that corners run counter-clockwise seen from where the vertex normals point.
void check_fronts(const Mesh& mesh) {
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
        const uint32_t* const c = &mesh.indices[i];
        const Vec3 a = mesh.positions[c[0]], across = cross(mesh.positions[c[1]] - a, mesh.positions[c[2]] - a);
        if (dot(across, mesh.normals[c[0]]) <= 0) FAIL("a triangle is turned round");
    }
}

} // namespace

TEST_CASE("shapes: spheres, disks and cylinders have the area, the front and the coordinates of their formulas") {
    const Mesh sphere = make_sphere(-1, 1, 2 * kPi);
    CHECK(area_of(sphere) == doctest::Approx(4 * kPi).epsilon(2e-3));
    check_fronts(sphere);
    for (std::size_t i = 0; i < sphere.positions.size(); ++i) {
        if (std::abs(length(sphere.positions[i]) - 1) > 1e-6f) FAIL("a vertex is off the sphere");
        if (length(sphere.normals[i] - sphere.positions[i]) > 1e-5f) FAIL("a normal is not the sphere's");
    }
    // No chord is further from the sphere than the header says.
    float least = 1;
    for (std::size_t i = 0; i < sphere.indices.size(); i += 3)
        least =
            min(least, length(0.5f * (sphere.positions[sphere.indices[i]] + sphere.positions[sphere.indices[i + 2]])));
    CHECK(least > 1 - 7e-4f);
    CHECK(sphere.uv[0].front() == Vec2{0, 1}); // v = 0 at zmin, upwards; the mesh holds 1 - v
    CHECK(sphere.uv[0].back() == Vec2{1, 0});

    CHECK(area_of(make_sphere(0, 1, kPi)) == doctest::Approx(kPi).epsilon(2e-3));
    const Mesh disk = make_disk(0.5f, 2 * kPi);
    CHECK(area_of(disk) == doctest::Approx(kPi * 0.75f).epsilon(1e-3));
    check_fronts(disk);
    CHECK(disk.normals[0] == Vec3{0, 0, 1});
    CHECK(disk.uv[0].front() == Vec2{0, 1}); // v = 0 at the rim
    const Mesh cylinder = make_cylinder(-1, 2, kPi / 2);
    CHECK(area_of(cylinder) == doctest::Approx(1.5f * kPi).epsilon(1e-3));
    check_fronts(cylinder);
    CHECK(cylinder.positions.back().x == doctest::Approx(0).epsilon(1e-6));
    CHECK(cylinder.positions.back().z == 2);
}

TEST_CASE("shapes: a flat patch is two triangles, and a curved one follows its formula") {
    Mesh flat;
    flat.positions = {{0, 0, 0}, {2, 0, 0}, {0, 1, 0}, {2, 1, 0}};
    flat.uv[0] = {{0, 1}, {1, 1}, {0, 0}, {1, 0}};
    triangulate_patches({{0, 1, 2, 3}}, flat);
    CHECK(flat.indices == std::vector<uint32_t>{0, 1, 3, 0, 3, 2});
    CHECK(flat.normals.empty());
    Mesh bent;
    bent.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 1}};
    triangulate_patches({{0, 1, 2, 3}}, bent);
    CHECK(bent.triangle_count() > 100);
    for (std::size_t i = 0; i < bent.positions.size(); ++i) { // z = x y
        const Vec3 p = bent.positions[i];
        CHECK(p.z == doctest::Approx(p.x * p.y));
        CHECK(length(bent.normals[i] - normalize(Vec3{-p.y, -p.x, 1})) < 1e-5f);
        CHECK(bent.uv[0][i] == Vec2{p.x, 1 - p.y});
    }
    check_fronts(bent);
}

TEST_CASE("Loop subdivision converges to the analytic limit") {
    Mesh octahedron;
    octahedron.positions = {{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    octahedron.indices = {0, 1, 4, 1, 2, 4, 2, 3, 4, 3, 0, 4, 1, 0, 5, 2, 1, 5, 3, 2, 5, 0, 3, 5};
    Mesh limit = octahedron;
    CHECK(subdivide_loop(0, limit) == 0);
    CHECK(limit.positions[0].x == doctest::Approx(0.5)); // 1 - 4 / (4 + 3 / (8 3/32))
    CHECK(limit.normals[0].x == doctest::Approx(1));
    Mesh fine = octahedron;
    CHECK(subdivide_loop(3, fine) == 3);
    CHECK(fine.triangle_count() == 8 * 64);
    CHECK(fine.positions[0].x == doctest::Approx(0.5)); // limits stay
    check_fronts(fine);
    Mesh triangle; // boundaries are cubic splines: a corner's limit is 2/3, 1/6, 1/6
    triangle.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    triangle.indices = {0, 1, 2};
    subdivide_loop(2, triangle);
    CHECK(triangle.positions[0].x == doctest::Approx(1.0 / 6));
    CHECK(triangle.positions[0].y == doctest::Approx(1.0 / 6));
    for (const Vec3& p : triangle.positions) CHECK(p.z == 0);
    Mesh many = octahedron;
    CHECK(subdivide_loop(31, many) == 8); // 8 * 4^8 triangles are the last below the limit
}

TEST_CASE("pbrt: shapes are placed and sized by their parameters") {
    const Scene scene = load_shapes(
        "Shape \"sphere\" \"float radius\" 2 \"float zmin\" 0\n"
        "Shape \"disk\" \"float radius\" 3 \"float height\" 1 \"float innerradius\" 1\n"
        "Shape \"cylinder\" \"float radius\" 2 \"float zmin\" -1 \"float zmax\" 4 \"float phimax\" 90\n"
        "Shape \"bilinearmesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 0]\n"
        "Shape \"loopsubdiv\" \"integer levels\" 1 \"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer indices\" [0 1 2]\n");
    REQUIRE(scene.instances.size() == 5);
    const auto box = [&](std::size_t i) {
        Bounds3 bounds;
        for (const Vec3& p : scene.meshes[scene.instances[i].mesh].positions)
            bounds.extend(transform_point(scene.instances[i].world_from_local, p));
        return bounds;
    };
    CHECK(box(0).lo.z == doctest::Approx(0));
    CHECK(box(0).hi.z == doctest::Approx(2));
    CHECK(box(0).lo.x == doctest::Approx(-2));
    CHECK(box(1).lo.z == doctest::Approx(1));
    CHECK(box(1).hi.x == doctest::Approx(3));
    CHECK(box(2).lo.z == doctest::Approx(-1));
    CHECK(box(2).hi.z == doctest::Approx(4));
    CHECK(box(2).lo.x == doctest::Approx(0).epsilon(1e-5));
    CHECK(box(3).hi.y == doctest::Approx(1));
    CHECK(scene.meshes[scene.instances[4].mesh].triangle_count() == 4);
}

TEST_CASE("pbrt: the front is where normals point, and ReverseOrientation turns it") {
    const std::string plain = "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer indices\" [0 1 2]\n";
    const std::string behind = "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer indices\" [0 1 2] "
                               "\"normal N\" [0 0 -1 0 0 -1 0 0 -1] \"point2 uv\" [0 0 1 0 0 1]\n";
    const Scene scene = load_shapes(plain + behind + "ReverseOrientation " + plain + behind +
                                    "Shape \"sphere\"\nReverseOrientation\nShape \"sphere\"\n");
    CHECK(scene.meshes[0].indices == std::vector<uint32_t>{0, 1, 2});
    CHECK(scene.meshes[1].indices == std::vector<uint32_t>{0, 2, 1});
    CHECK(scene.meshes[1].uv[0] == std::vector<Vec2>{{0, 1}, {1, 1}, {0, 0}});
    CHECK(scene.meshes[2].indices == std::vector<uint32_t>{0, 2, 1});
    CHECK(scene.meshes[3].indices == std::vector<uint32_t>{0, 1, 2});
    CHECK(scene.meshes[3].normals[0] == Vec3{0, 0, 1});
    REQUIRE(scene.meshes.size() == 6);
    CHECK(dot(scene.meshes[4].normals[5], scene.meshes[4].positions[5]) < 0);
    check_fronts(scene.meshes[4]);
    check_fronts(scene.meshes[5]);
}

TEST_CASE("pbrt: a PLY file is read once, and gives its geometry alone") {
    const fs::path folder = test::scratch_folder();
    test::write_text(
        folder / "part.ply",
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
        "property float u\nproperty float v\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
        "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
        "0 0 0 0 0 1 2 3\n1 0 0 1 0 1 2 3\n1 1 0 1 1 1 2 3\n0 1 0 0 1 1 2 3\n4 0 1 2 3\n");
    Messages messages;
    const Scene scene = read_scene(
        test::write_text(folder / "scene.pbrt", "WorldBegin Shape \"plymesh\" \"string filename\" \"part.ply\"\n"
                                                "Translate 1 0 0 Shape \"plymesh\" \"string filename\" \"part.ply\"\n"
                                                "Shape \"plymesh\" \"string filename\" \"bad.ply\"\n"),
        {}, messages);
    CHECK(messages.left_out().size() == 1);
    REQUIRE(scene.instances.size() == 2);
    CHECK(scene.meshes.size() == 1);
    CHECK(scene.instances[0].name == "part");
    CHECK(scene.meshes[0].triangle_count() == 2);
    CHECK(scene.meshes[0].colors.empty());
    CHECK(scene.meshes[0].uv[0][2] == Vec2{1, 0});
}
