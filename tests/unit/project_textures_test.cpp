// Texture coordinates by pbrt's planar, spherical and cylindrical mappings, at the vertices of meshes.

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <tuple>

#include <fmt/format.h>

#include "formats/read_scene.h"
#include "image/write_image.h"
#include "scene/scene.h"
#include "tests/support/options.h"
#include "tests/support/write_text.h"

using namespace pertev;

namespace {

struct Projected {
    Scene scene;
    Messages messages;

    const Instance& instance(std::size_t i = 0) const { return scene.instances.at(i); }
    const Mesh& mesh(std::size_t i = 0) const { return scene.meshes.at(instance(i).mesh); }
    const Material& material(std::size_t i = 0) const { return scene.materials.at(instance(i).material); }
    /// Position of a vertex in the file's coordinates.
    DoubleVec3 point(uint32_t vertex, std::size_t i = 0) const {
        return to_double(transform_point(instance(i).world_from_local, mesh(i).positions.at(vertex))) +
               scene.origin_in_file;
    }
};

Projected read_mapped(const std::string& world) {
    const std::filesystem::path folder = test::scratch_folder();
    write_image(folder / "a.exr", Image{.width = 2, .height = 1, .channels = 3, .pixels = {0, 0, 0, 1, 1, 1}});
    Projected read;
    read.scene = read_scene(test::write_text(folder / "scene.pbrt", "WorldBegin\n" + world), {}, read.messages);
    REQUIRE(!read.scene.instances.empty());
    return read;
}

std::string textured(const std::string& mapping, const std::string& before = "") {
    return before + "Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"a.exr\" " + mapping +
           "\nIdentity\nMaterial \"diffuse\" \"texture reflectance\" \"t\"\n";
}

constexpr const char* kMappedTriangle =
    "Shape \"trianglemesh\" \"point3 P\" [1 2 3 3 2 4 1 5 2] \"integer indices\" [0 1 2]\n";
constexpr const char* kMappedSphere = "Shape \"sphere\" \"float radius\" 2\n";

} // namespace

TEST_CASE("a planar mapping has the coordinates of its plane, with and without a transform") {
    const std::string mapping = "\"string mapping\" \"planar\" \"vector3 v1\" [0 0 2] \"vector3 v2\" [1 0.5 0] "
                                "\"float udelta\" 0.25 \"float vdelta\" -1";
    for (const bool is_moved : {false, true}) {
        const Projected read =
            read_mapped(textured(mapping, is_moved ? "Translate 1 2 3 Scale 2 2 2\n" : "") + kMappedTriangle);
        CHECK(read.messages.left_out() == std::vector<std::string>{});
        CHECK(read.material().base_color_texture.uv_set == 1);
        REQUIRE(read.mesh().uv[1].size() == 3);
        for (uint32_t vertex = 0; vertex < 3; ++vertex) {
            DoubleVec3 p = read.point(vertex);
            if (is_moved) p = {0.5 * (p.x - 1), 0.5 * (p.y - 2), 0.5 * (p.z - 3)};
            const Vec2 uv = read.mesh().uv[1][vertex];
            CHECK(static_cast<double>(uv.x) == doctest::Approx(0.25 + 2 * p.z).epsilon(1e-6));
            CHECK(1 - static_cast<double>(uv.y) == doctest::Approx(-1 + p.x + 0.5 * p.y).epsilon(1e-6));
        }
    }
}

TEST_CASE("spherical and cylindrical mappings have pbrt's angles, also across the seam and at the axis") {
    for (const bool is_sphere : {true, false}) {
        CAPTURE(is_sphere);
        const Projected read = read_mapped(
            textured(is_sphere ? "\"string mapping\" \"spherical\"" : "\"string mapping\" \"cylindrical\"") +
            kMappedSphere);
        CHECK(read.messages.left_out() == std::vector<std::string>{});
        const Mesh& mesh = read.mesh();
        const std::vector<Vec2>& uv = mesh.uv[1];
        REQUIRE(uv.size() == mesh.positions.size());
        REQUIRE(mesh.normals.size() == mesh.positions.size());
        constexpr double kTurn = 6.283185307179586;
        double most_around = 0;
        for (std::size_t first = 0; first < mesh.indices.size(); first += 3) {
            double least = 9, greatest = -9;
            for (std::size_t k = first; k < first + 3; ++k) {
                const uint32_t vertex = mesh.indices[k];
                const DoubleVec3 p = read.point(vertex);
                const double s = static_cast<double>(uv[vertex].x), t = 1 - static_cast<double>(uv[vertex].y);
                const double around = is_sphere ? t : s;
                least = std::min(least, around), greatest = std::max(greatest, around);
                const double angle = std::atan2(p.y, p.x) / kTurn + (is_sphere ? 0 : 0.5);
                const bool is_on_axis = std::hypot(p.x, p.y) < 1e-5;
                if (!is_on_axis) CHECK(std::abs(around - angle - std::round(around - angle)) < 1e-5);
                const double height = p.z / std::sqrt(dot(p, p));
                const double along = is_sphere ? std::acos(std::clamp(height, -1.0, 1.0)) / (0.5 * kTurn) : height;
                CHECK(std::abs((is_sphere ? s : t) - along) < 1e-3);
            }
            most_around = std::max(most_around, greatest - least);
        }
        CHECK(most_around < 0.2);
        CHECK(most_around > 0);
    }
}

TEST_CASE("each placement of a shape has its own coordinates, and equal ones are shared") {
    const Projected read =
        read_mapped(textured("\"string mapping\" \"planar\"") + "ObjectBegin \"o\"\n" + kMappedTriangle +
                    "ObjectEnd\nObjectInstance \"o\"\n"
                    "Translate 5 0 0\nObjectInstance \"o\"\nObjectInstance \"o\"\n");
    REQUIRE(read.scene.instances.size() == 3);
    CHECK(read.instance(0).mesh != read.instance(1).mesh);
    CHECK(read.instance(1).mesh == read.instance(2).mesh);
    CHECK(static_cast<double>(read.mesh(1).uv[1][0].x - read.mesh(0).uv[1][0].x) == doctest::Approx(5));
}

TEST_CASE("two mappings of one material have two sets, a product keeps one, and opacities have theirs") {
    const std::string first = "Texture \"a\" \"float\" \"imagemap\" \"string filename\" \"a.exr\" "
                              "\"string mapping\" \"cylindrical\"\nTexture \"half\" \"float\" \"scale\" "
                              "\"texture tex\" \"a\" \"float scale\" 0.5\n";
    const Projected read = read_mapped(
        first +
        "Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"a.exr\" \"string mapping\" "
        "\"planar\"\nMaterial \"coateddiffuse\" \"texture reflectance\" \"t\" \"texture roughness\" \"half\"\n" +
        kMappedTriangle +
        "Shape \"trianglemesh\" \"point3 P\" [1 2 3 3 2 4 1 5 2] \"integer indices\" [0 1 2] \"texture alpha\" "
        "\"a\"\n");
    CHECK(read.messages.left_out() == std::vector<std::string>{});
    const Material& plain = read.material();
    CHECK(plain.base_color_texture.uv_set != plain.roughness_texture.uv_set);
    CHECK(plain.base_color_texture.uv_set + plain.roughness_texture.uv_set == 3);
    const Material& cut = read.material(1);
    CHECK(cut.alpha_texture.has_image());
    CHECK(cut.alpha_texture.uv_set == cut.roughness_texture.uv_set);
    CHECK(read.mesh(1).uv[2].size() == read.mesh(1).positions.size());
}

TEST_CASE("large triangles are divided, without gaps, until coordinates are right everywhere on them") {
    // A square before the axis, and one through whose middle the axis goes.
    const std::string squares[] = {"[1 -4 -4 1 4 -4 1 4 4 1 -4 4]", "[-4 -4 1 4 -4 1 4 4 1 -4 4 1]"};
    for (const bool is_sphere : {true, false})
        for (const std::string& square : squares) {
            CAPTURE(is_sphere);
            CAPTURE(square);
            const Projected read = read_mapped(
                textured(is_sphere ? "\"string mapping\" \"spherical\"" : "\"string mapping\" \"cylindrical\"") +
                "Shape \"trianglemesh\" \"point3 P\" " + square + " \"integer indices\" [0 1 2 0 2 3]\n");
            CHECK(read.messages.all().size() == 0);
            const Mesh& mesh = read.mesh();
            CHECK(mesh.triangle_count() > 100);
            CHECK(mesh.triangle_count() < 20'000);
            double worst = 0, area = 0;
            std::map<std::array<float, 6>, int> edges; // how many triangles have each, one at the outline
            for (std::size_t first = 0; first < mesh.indices.size(); first += 3) {
                const auto at = [&](std::size_t k) { return read.point(mesh.indices[first + k % 3]); };
                const DoubleVec3 normal = cross(at(1) - at(0), at(2) - at(0));
                area += 0.5 * std::sqrt(dot(normal, normal));
                CHECK((square[1] == '1' ? normal.x : normal.z) > 0);
                for (std::size_t k = 0; k < 3; ++k) {
                    const Vec3 a = to_float(at(k)), b = to_float(at(k + 1));
                    ++edges[std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z)
                                ? std::array{a.x, a.y, a.z, b.x, b.y, b.z}
                                : std::array{b.x, b.y, b.z, a.x, a.y, a.z}];
                }
                for (const std::array<double, 3>& share :
                     {std::array{0.5, 0.25, 0.25}, std::array{0.2, 0.2, 0.6}, std::array{0.1, 0.8, 0.1}}) {
                    DoubleVec3 p = {};
                    double s = 0, t = 1;
                    for (std::size_t k = 0; k < 3; ++k) {
                        const DoubleVec3 q = at(k);
                        p = p + DoubleVec3{share[k] * q.x, share[k] * q.y, share[k] * q.z};
                        s += share[k] * static_cast<double>(mesh.uv[1][mesh.indices[first + k]].x);
                        t -= share[k] * static_cast<double>(mesh.uv[1][mesh.indices[first + k]].y);
                    }
                    constexpr double kTurn = 6.283185307179586;
                    const double angle = std::atan2(p.y, p.x) / kTurn + (is_sphere ? 0 : 0.5),
                                 length = std::sqrt(dot(p, p));
                    const double around = (is_sphere ? t : s) - angle;
                    const double along = is_sphere ? s - 2 * std::acos(p.z / length) / kTurn : t - p.z / length;
                    worst = std::max(worst, std::abs(along));
                    if (std::hypot(p.x, p.y) > 0.1) worst = std::max(worst, std::abs(around - std::round(around)));
                }
            }
            CHECK(worst < 3e-3); // edges are right to a thousandth
            CHECK(area == doctest::Approx(64).epsilon(1e-5));
            double outline = 0;
            for (const auto& [ends, count] : edges) {
                REQUIRE(count < 3);
                if (count == 1)
                    outline += static_cast<double>(std::hypot(ends[3] - ends[0], ends[4] - ends[1], ends[5] - ends[2]));
            }
            CHECK(outline == doctest::Approx(32).epsilon(1e-5));
        }
}

TEST_CASE("triangles with a power each are not divided, and those without coordinates divide theirs") {
    const std::string square = "Shape \"trianglemesh\" \"point3 P\" [1 -4 -4 1 4 -4 1 4 4 1 -4 4] "
                               "\"integer indices\" [0 1 2 0 2 3]\n";
    const Projected lamp = read_mapped(textured("\"string mapping\" \"spherical\"") +
                                       "AreaLightSource \"diffuse\" \"float power\" 5\n" + square);
    CHECK(lamp.mesh().triangle_count() == 2);
    CHECK(lamp.messages.all().size() == 1);
    const Projected cut = read_mapped("Texture \"own\" \"float\" \"imagemap\" \"string filename\" \"a.exr\"\n" +
                                      textured("\"string mapping\" \"spherical\"") +
                                      square.substr(0, square.size() - 1) + " \"texture alpha\" \"own\"\n");
    const Mesh& mesh = cut.mesh();
    REQUIRE(mesh.uv[0].size() == mesh.positions.size());
    CHECK(mesh.triangle_count() > 100);
    for (uint32_t vertex = 0; vertex < mesh.positions.size(); ++vertex) { // pbrt's (0,0), (1,0), (1,1) of each triangle
        const DoubleVec3 p = cut.point(vertex);
        const double y = (p.y + 4) / 8, z = (p.z + 4) / 8, u = static_cast<double>(mesh.uv[0][vertex].x),
                     v = 1 - static_cast<double>(mesh.uv[0][vertex].y);
        const bool is_first = std::abs(u - y) + std::abs(v - z) < 1e-5,
                   is_second = std::abs(u - z) + std::abs(v - z + y) < 1e-5;
        CHECK((is_first || is_second));
    }
}

TEST_CASE("coordinates repeat around an axis, and a fourth mapping causes a message") {
    const std::string clamped = "\"string wrap\" \"clamp\" \"string mapping\" ";
    const TextureRef sphere =
        read_mapped(textured(clamped + "\"spherical\"") + kMappedSphere).material().base_color_texture;
    CHECK(sphere.wrap_t == Wrap::Repeat);
    CHECK(sphere.wrap_s == Wrap::ClampToEdge);
    const TextureRef cylinder =
        read_mapped(textured(clamped + "\"cylindrical\"") + kMappedSphere).material().base_color_texture;
    CHECK(cylinder.wrap_s == Wrap::Repeat);
    CHECK(cylinder.wrap_t == Wrap::ClampToEdge);
    std::string four, slots;
    for (const char* const slot : {"reflectance", "roughness", "thickness", "eta"}) {
        four += fmt::format(
            "Texture \"{0}\" \"{1}\" \"imagemap\" \"string filename\" \"a.exr\" \"string mapping\" \"planar\" "
            "\"float udelta\" {2}\n",
            slot, slots.empty() ? "spectrum" : "float", four.size());
        slots += fmt::format(" \"texture {0}\" \"{0}\"", slot);
    }
    const Projected read = read_mapped(four + "Material \"coateddiffuse\"" + slots + "\n" + kMappedTriangle);
    CHECK(read.mesh().uv[1].size() == 3);
    const Projected far =
        read_mapped(textured("\"string mapping\" \"spherical\"", "Scale 1e60 1e60 1e60\n") + kMappedTriangle);
    CHECK(static_cast<double>(far.mesh().uv[1].at(0).x) ==
          doctest::Approx(std::acos(3 / std::sqrt(14.0)) / 3.14159265).epsilon(1e-5));
}

TEST_CASE("pbrt-v3 has planes in the world, and what has no mapping is left out with a message") {
    const Projected version_3 =
        read_mapped("Translate 7 0 0\nTexture \"t\" \"color\" \"checkerboard\" \"string mapping\" "
                    "\"planar\"\nIdentity\nMaterial \"matte\" \"texture Kd\" \"t\"\n" +
                    std::string(kMappedTriangle) + "WorldEnd\n");
    CHECK(static_cast<double>(version_3.mesh().uv[1].at(0).x) == doctest::Approx(version_3.point(0).x));
    const Projected unknown = read_mapped(textured("\"string mapping\" \"spheric\"") + kMappedTriangle);
    CHECK(unknown.messages.left_out().size() == 1);
    CHECK(unknown.material().base_color_texture.uv_set == 0);
    const Projected flat = read_mapped(textured("\"string mapping\" \"planar\"", "Scale 1 1 0\n") + kMappedTriangle);
    CHECK(flat.messages.left_out().size() == 1);
    CHECK(flat.material().base_color_texture.uv_set == 0);
}
