// Texture coordinates by pbrt's planar, spherical and cylindrical mappings, at the vertices of meshes.

#include <doctest/doctest.h>

#include <cmath>
#include <string>

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
                const double along = is_sphere ? std::acos(std::clamp(p.z / 2, -1.0, 1.0)) / (0.5 * kTurn) : p.z / 2;
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
    CHECK(read.mesh(1).uv[2].size() == 3);
}

TEST_CASE("coordinates repeat around an axis, and large triangles and a fourth mapping cause messages") {
    const std::string clamped = "\"string wrap\" \"clamp\" \"string mapping\" ";
    const TextureRef sphere =
        read_mapped(textured(clamped + "\"spherical\"") + kMappedSphere).material().base_color_texture;
    CHECK(sphere.wrap_t == Wrap::Repeat);
    CHECK(sphere.wrap_s == Wrap::ClampToEdge);
    const TextureRef cylinder =
        read_mapped(textured(clamped + "\"cylindrical\"") + kMappedSphere).material().base_color_texture;
    CHECK(cylinder.wrap_s == Wrap::Repeat);
    CHECK(cylinder.wrap_t == Wrap::ClampToEdge);
    const std::string large = "Shape \"trianglemesh\" \"point3 P\" [1 -9 0 1 9 0 1 0 9] \"integer indices\" [0 1 2]\n";
    const auto messages_of = [](const std::string& world) { return read_mapped(world).messages.all().size(); };
    CHECK(messages_of(textured("\"string mapping\" \"spherical\"") + large) == 1 + messages_of(textured("") + large));
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
