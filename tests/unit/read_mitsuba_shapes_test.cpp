// Shapes, emitters and instances of Mitsuba's scenes.

#include <doctest/doctest.h>
#include <fmt/format.h>
#include <zlib.h>

#include <cstring>

#include "formats/described/environment.h"
#include "formats/mitsuba/read_serialized.h"
#include "formats/mitsuba/shapes.h"
#include "formats/read_scene.h"
#include "image/write_image.h"
#include "math/portable_math.h"
#include "scene/intensity_table.h"
#include "tests/support/mitsuba_materials.h"
#include "tests/support/thrown_error.h"
#include "tests/support/write_text.h"

namespace fs = std::filesystem;
using namespace pertev;

namespace {

Scene load_mitsuba_shapes(const fs::path& folder, const std::string& text, Messages& messages,
                          const char* version = "3.0.0") {
    return read_scene(
        test::write_text(folder / "scene.xml", fmt::format("<scene version=\"{}\">{}</scene>", version, text)), {},
        messages);
}
Scene load_mitsuba_shapes(const std::string& text, const char* version = "3.0.0") {
    Messages messages;
    Scene scene = load_mitsuba_shapes(test::scratch_folder(), text, messages, version);
    CHECK(test::left_out_besides_backs(messages) == std::vector<std::string>{});
    return scene;
}
std::string shape_of(const std::string& type, const std::string& inner = "") {
    return fmt::format("<shape type=\"{}\">{}</shape>", type, inner);
}
std::string named_file(const char* name) { return fmt::format("<string name=\"filename\" value=\"{}\"/>", name); }

/// The box of an instance in the world.
Bounds3 world_box(const Scene& scene, std::size_t i = 0) {
    Bounds3 box;
    const Instance& instance = scene.instances.at(i);
    for (const uint32_t k : scene.meshes.at(instance.mesh).indices)
        box.extend(transform_point(instance.world_from_local, scene.meshes[instance.mesh].positions[k]));
    return box;
}
void check_world_box(const Bounds3& box, Vec3 lo, Vec3 hi) {
    CHECK(length(box.lo - lo) < 2e-3f);
    CHECK(length(box.hi - hi) < 2e-3f);
}
/// The geometric normal of the first triangle, as its corners run.
Vec3 front_of_first(const Mesh& mesh) {
    const Vec3 a = mesh.positions[mesh.indices[0]], b = mesh.positions[mesh.indices[1]],
               c = mesh.positions[mesh.indices[2]];
    return normalize(cross(b - a, c - a));
}

template <class T>
void put_value(std::string& to, T value) {
    to.append(reinterpret_cast<const char*>(&value), sizeof value);
}
std::string deflated_bytes(const std::string& content) {
    std::string to(compressBound(content.size()), '\0');
    uLongf size = to.size();
    compress(reinterpret_cast<Bytef*>(to.data()), &size, reinterpret_cast<const Bytef*>(content.data()),
             content.size());
    to.resize(size);
    return to;
}
/// The content of a serialized mesh: a triangle with coordinates at height z.
std::string serialized_triangle(bool is_double, bool has_name, float z, uint64_t vertices = 3, uint64_t triangles = 1) {
    std::string to;
    put_value(to, uint32_t((is_double ? 0x2000 : 0x1000) | 2));
    if (has_name) to += std::string("tri") + '\0';
    put_value(to, vertices);
    put_value(to, triangles);
    const auto number = [&](float x) { is_double ? put_value(to, double(x)) : put_value(to, x); };
    for (const float x : {0.0f, 0.0f, z, 1.0f, 0.0f, z, 0.0f, 1.0f, z}) number(x);
    for (const float x : {0.0f, 0.0f, 1.0f, 0.0f, 0.0f, 0.25f}) number(x);
    for (const uint32_t i : {0u, 1u, 2u}) put_value(to, i);
    return to;
}
std::string serialized_file(uint16_t version, const std::vector<std::string>& meshes) {
    std::string to;
    std::vector<uint64_t> offsets;
    for (const std::string& mesh : meshes) {
        offsets.push_back(to.size());
        put_value(to, uint16_t(0x041C));
        put_value(to, version);
        to += deflated_bytes(mesh);
    }
    for (const uint64_t offset : offsets) version >= 4 ? put_value(to, offset) : put_value(to, uint32_t(offset));
    put_value(to, uint32_t(meshes.size()));
    return to;
}
std::span<const std::byte> bytes_in(const std::string& text) {
    return {reinterpret_cast<const std::byte*>(text.data()), text.size()};
}

} // namespace

TEST_CASE("mitsuba: analytic shapes have their positions and normals") {
    check_world_box(world_box(load_mitsuba_shapes(shape_of("rectangle"))), {-1, -1, 0}, {1, 1, 0});
    check_world_box(world_box(load_mitsuba_shapes(shape_of("cube"))), {-1, -1, -1}, {1, 1, 1});
    check_world_box(
        world_box(load_mitsuba_shapes(shape_of(
            "sphere", "<point name=\"center\" x=\"1\" y=\"2\" z=\"3\"/><float name=\"radius\" value=\".5\"/>"))),
        {0.5f, 1.5f, 2.5f}, {1.5f, 2.5f, 3.5f});
    check_world_box(world_box(load_mitsuba_shapes(
                        shape_of("disk", "<transform name=\"to_world\"><scale value=\"2\"/></transform>"))),
                    {-2, -2, 0}, {2, 2, 0});
    check_world_box(world_box(load_mitsuba_shapes(shape_of(
                        "cylinder", "<point name=\"p0\" x=\"0\" y=\"0\" z=\"1\"/><point name=\"p1\" x=\"4\" y=\"0\" "
                                    "z=\"1\"/><float name=\"radius\" value=\".5\"/>"))),
                    {0, -0.5f, 0.5f}, {4, 0.5f, 1.5f});
    CHECK(front_of_first(load_mitsuba_shapes(shape_of("rectangle")).meshes[0]).z == 1);
    const Scene flipped = load_mitsuba_shapes(shape_of("rectangle", "<boolean name=\"flip_normals\" value=\"true\"/>"));
    CHECK(front_of_first(flipped.meshes[0]).z == -1);
    CHECK(flipped.meshes[0].normals[0].z == -1);
    const Mesh cube = mitsuba::make_cube();
    for (std::size_t i = 0; i < cube.indices.size(); i += 3) {
        const Vec3 a = cube.positions[cube.indices[i]], b = cube.positions[cube.indices[i + 1]],
                   c = cube.positions[cube.indices[i + 2]];
        CHECK(dot(cross(b - a, c - a), cube.normals[cube.indices[i]]) == doctest::Approx(4));
    }
}

TEST_CASE("mitsuba: texture coordinates of shapes are Mitsuba's") {
    const auto uv_at = [](const Mesh& mesh, Vec3 p) {
        for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
            if (length(mesh.positions[i] - p) < 1e-5f) return mesh.uv[0][i];
        }
        return Vec2{-1, -1};
    };
    const Mesh square = load_mitsuba_shapes(shape_of("rectangle")).meshes[0];
    CHECK(uv_at(square, {-1, -1, 0}) == Vec2{0, 0});
    CHECK(uv_at(square, {1, -1, 0}) == Vec2{1, 0});
    CHECK(uv_at(mitsuba::make_cube(), {1, -1, -1}) == Vec2{0, 1});
    const Mesh sphere = load_mitsuba_shapes(shape_of("sphere")).meshes[0]; // v begins at +z
    CHECK(uv_at(sphere, {0, 0, 1}).y == doctest::Approx(0));
    CHECK(uv_at(sphere, {0, 1, 0}).x == doctest::Approx(0.25));
    CHECK(uv_at(sphere, {0, 1, 0}).y == doctest::Approx(0.5));
    const Mesh disk = load_mitsuba_shapes(shape_of("disk")).meshes[0]; // the radius and the angle
    CHECK(uv_at(disk, {0, 1, 0}).x == doctest::Approx(1));
    CHECK(uv_at(disk, {0, 1, 0}).y == doctest::Approx(0.25));
    const Mesh tube = load_mitsuba_shapes(shape_of("cylinder")).meshes[0];
    CHECK(uv_at(tube, {0, 1, 1}).x == doctest::Approx(0.25));
    CHECK(uv_at(tube, {0, 1, 1}).y == doctest::Approx(1));
}

TEST_CASE("mitsuba: a cylinder's u begins where Mitsuba's does, and normal maps have Mitsuba's tangents") {
    const Scene tube = load_mitsuba_shapes(shape_of("cylinder", "<point name=\"p1\" x=\"0\" y=\"2\" z=\"0\"/>"));
    // Mitsuba 3.9 has u = 0 at +x, and goes to -z, around this one.
    const Mesh& mesh = tube.meshes[0];
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        const Vec3 p = transform_point(tube.instances[0].world_from_local, mesh.positions[i]);
        if (mesh.uv[0][i].x == 0) CHECK(p.x == doctest::Approx(1));
        if (mesh.uv[0][i].x == 0.25f) CHECK(p.z == doctest::Approx(-1));
    }
    const fs::path folder = test::scratch_folder();
    write_image(folder / "n.exr", Image{.width = 1, .height = 1, .channels = 3, .pixels = {0.5f, 0.5f, 1}});
    Messages messages;
    const Scene scene = load_mitsuba_shapes(
        folder,
        shape_of("rectangle") +
            shape_of("rectangle", "<bsdf type=\"normalmap\"><texture name=\"normalmap\" "
                                  "type=\"bitmap\">" +
                                      named_file("n.exr") + "</texture><bsdf type=\"diffuse\"/></bsdf>"),
        messages);
    REQUIRE(scene.meshes.size() == 2); // the other has none
    CHECK(scene.meshes[0].tangents.empty());
    REQUIRE(scene.meshes[1].tangents.size() == 4);
    for (const Vec4 t : scene.meshes[1].tangents) {
        CHECK(t.x == doctest::Approx(1));
        CHECK(t.w == 1); // so y is up, where v = 0 is below
    }
    const std::string bumpy = "<bsdf type=\"normalmap\"><texture name=\"normalmap\" type=\"bitmap\">" +
                              named_file("n.exr") + "</texture><bsdf type=\"diffuse\"/></bsdf>";
    const Scene mirrored = load_mitsuba_shapes(
        folder,
        shape_of("rectangle", bumpy) +
            shape_of("rectangle", "<transform name=\"to_world\"><scale x=\"-1\"/></transform>" + bumpy),
        messages);
    REQUIRE(mirrored.meshes.size() == 2); // since the bitangent is across normal and tangent in the world
    CHECK(mirrored.meshes[0].tangents.at(0).w == 1);
    CHECK(mirrored.meshes[1].tangents.at(0).w == -1);
}

TEST_CASE("mitsuba: mesh files have smooth normals unless face_normals is set; flip_tex_coords flips v") {
    const fs::path folder = test::scratch_folder();
    test::write_text(folder / "roof.obj", "v 0 0 0\nv 1 0 1\nv 2 0 0\nv 0 1 0\nv 1 1 1\nv 2 1 0\nvt 0 .25\n"
                                          "f 1/1 2/1 5/1 4/1\nf 2/1 3/1 6/1 5/1\n");
    test::write_text(folder / "a.ply",
                     "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
                     "property float u\nproperty float v\nelement face 1\nproperty list uchar int vertex_indices\n"
                     "end_header\n0 0 0 0 .25\n1 0 0 0 .25\n0 1 0 0 .25\n3 0 1 2\n");
    Messages messages;
    const std::string flat = "<boolean name=\"face_normals\" value=\"true\"/>",
                      flip = "<boolean name=\"flip_tex_coords\" value=\"{}\"/>";
    const Scene scene = load_mitsuba_shapes(
        folder,
        shape_of("obj", named_file("roof.obj")) + shape_of("obj", named_file("roof.obj") + flat) +
            shape_of("obj", named_file("roof.obj") + "<boolean name=\"flip_tex_coords\" value=\"false\"/>") +
            shape_of("ply", named_file("a.ply")) +
            shape_of("ply", named_file("a.ply") + "<boolean name=\"flip_tex_coords\" value=\"true\"/>"),
        messages);
    CHECK(test::left_out_besides_backs(messages) == std::vector<std::string>{});
    REQUIRE(scene.meshes.size() == 5);
    const Mesh& smooth = scene.meshes[0];
    REQUIRE(!smooth.normals.empty());
    for (std::size_t i = 0; i < smooth.positions.size(); ++i) {
        if (smooth.positions[i].x == 1) CHECK(smooth.normals[i].z == doctest::Approx(1)); // the ridge
    }
    CHECK(scene.meshes[1].normals.empty());
    CHECK(smooth.uv[0][0].y == 0.75f);
    CHECK(scene.meshes[2].uv[0][0].y == 0.25f);
    CHECK(scene.meshes[3].uv[0][0].y == 0.25f);
    CHECK(scene.meshes[4].uv[0][0].y == 0.75f);
}

TEST_CASE("mitsuba: mesh_attribute has the numbers of a PLY's vertices, for its shapes alone") {
    const fs::path folder = test::scratch_folder();
    test::write_text(folder / "c.ply",
                     "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
                     "property float r\nproperty float g\nproperty float b\nelement face 1\nproperty list uchar int "
                     "vertex_indices\nend_header\n0 0 0 .25 .5 1\n1 0 0 .25 .5 1\n0 1 0 .25 .5 1\n3 0 1 2\n");
    Messages messages;
    const std::string colored =
        "<bsdf type=\"diffuse\"><texture type=\"mesh_attribute\" name=\"reflectance\"><string name=\"name\" "
        "value=\"vertex_color\"/></texture></bsdf>";
    const Scene scene = load_mitsuba_shapes(
        folder, shape_of("ply", named_file("c.ply") + colored) + shape_of("ply", named_file("c.ply")), messages);
    CHECK(test::left_out_besides_backs(messages) == std::vector<std::string>{});
    REQUIRE(scene.meshes.size() == 2);
    REQUIRE(scene.meshes[0].colors.size() == 3);
    CHECK(scene.meshes[0].colors[0].x == doctest::Approx(0.25));
    CHECK(scene.meshes[0].colors[0].y == doctest::Approx(0.5));
    CHECK(scene.meshes[1].colors.empty());
    CHECK(scene.materials[scene.instances[0].material].base_color == grey(1));
    Messages none;
    (void)load_mitsuba_shapes(folder, shape_of("rectangle", colored), none);
    CHECK(none.left_out().empty()); // the factor is white
}

TEST_CASE("mitsuba: equal shapes share a mesh, groups are instanced") {
    const Scene scene = load_mitsuba_shapes("<shape type=\"shapegroup\" id=\"pair\">" +
                                            shape_of("sphere", "<point name=\"center\" x=\"5\" y=\"0\" z=\"0\"/>") +
                                            shape_of("sphere") + "</shape>" +
                                            "<shape type=\"instance\"><ref id=\"pair\"/><transform "
                                            "name=\"to_world\"><translate y=\"10\"/></transform></shape>"
                                            "<shape type=\"instance\"><ref id=\"pair\"/></shape>" +
                                            shape_of("sphere"));
    CHECK(scene.meshes.size() == 1);
    REQUIRE(scene.instances.size() == 5);
    check_world_box(world_box(scene, 0), {4, 9, -1}, {6, 11, 1});
    check_world_box(world_box(scene, 4), {-1, -1, -1}, {1, 1, 1});
}

TEST_CASE("mitsuba: a mirrored file without normals has its front where its mirrored corners say") {
    const fs::path folder = test::scratch_folder();
    test::write_text(folder / "t.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    Messages messages;
    const Scene scene = load_mitsuba_shapes(
        folder,
        shape_of("obj", named_file("t.obj") + "<transform name=\"to_world\"><scale x=\"-1\"/></transform>") +
            shape_of("rectangle", "<transform name=\"to_world\"><scale x=\"-1\"/></transform>"),
        messages);
    CHECK(front_of_first(scene.meshes[0]).z == -1);
    CHECK(front_of_first(scene.meshes[1]).z == 1);
}

TEST_CASE("mitsuba: serialized meshes of both versions, by their number, in floats and doubles") {
    const std::string three =
        serialized_file(3, {serialized_triangle(false, false, 1), serialized_triangle(true, false, 2)});
    const auto first = mitsuba::read_serialized(bytes_in(three), 0, "m.serialized");
    CHECK(first.mesh.positions[1] == Vec3{1, 0, 1});
    CHECK(first.exact.empty());
    const auto second = mitsuba::read_serialized(bytes_in(three), 1, "m.serialized");
    CHECK(second.exact[2].z == 2);
    CHECK(second.mesh.uv[0][2].y == 0.25f);
    CHECK(second.mesh.indices == std::vector<uint32_t>{0, 1, 2});
    const fs::path folder = test::scratch_folder();
    test::write_text(folder / "m.serialized",
                     serialized_file(4, {serialized_triangle(false, true, 1), serialized_triangle(false, true, 7)}));
    Messages messages;
    const Scene scene = load_mitsuba_shapes(
        folder, shape_of("serialized", named_file("m.serialized") + "<integer name=\"shapeIndex\" value=\"1\"/>"),
        messages, "0.6.0");
    REQUIRE(scene.instances.size() == 1);
    check_world_box(world_box(scene), {0, 0, 7}, {1, 1, 7});
    CHECK(scene.meshes[0].uv[0][2].y == 0.25f);
}

TEST_CASE("mitsuba: damaged and untrue serialized meshes are refused") {
    const auto refuses = [](const std::string& bytes, uint32_t index = 0) {
        const auto error = test::thrown_error([&] { (void)mitsuba::read_serialized(bytes_in(bytes), index, "m"); });
        return error && error->code() == ErrorCode::BadInput;
    };
    const std::string good = serialized_file(4, {serialized_triangle(false, true, 1)});
    CHECK(!refuses(good));
    CHECK(refuses(good, 1));
    for (std::size_t size = 0; size < good.size(); ++size) CHECK(refuses(good.substr(0, size)));
    CHECK(refuses(serialized_file(4, {serialized_triangle(false, true, 1, uint64_t(1) << 60, 1)})));
    CHECK(refuses(serialized_file(4, {serialized_triangle(false, true, 1, 3, uint64_t(1) << 62)})));
    CHECK(refuses(serialized_file(5, {serialized_triangle(false, true, 1)})));
    std::string wrong = good;
    wrong[good.size() - 12] = '\x7f'; // the offset of the mesh
    CHECK(refuses(wrong));
    std::string torn = good;
    torn[20] = static_cast<char>(torn[20] ^ 0x55);
    CHECK((refuses(torn) || !mitsuba::read_serialized(bytes_in(torn), 0, "m").mesh.indices.empty()));
}

TEST_CASE("mitsuba: point, spot and directional emitters") {
    const Scene scene = load_mitsuba_shapes(shape_of("rectangle") +
                                            "<emitter type=\"point\"><point name=\"position\" x=\"1\" y=\"2\" "
                                            "z=\"3\"/><rgb name=\"intensity\" value=\"4 5 6\"/></emitter>"
                                            "<emitter type=\"spot\"><transform name=\"to_world\"><lookat "
                                            "origin=\"0,0,5\" target=\"0,0,0\" up=\"0,1,0\"/></transform>"
                                            "<float name=\"cutoff_angle\" value=\"30\"/></emitter>"
                                            "<emitter type=\"directional\"><vector name=\"direction\" x=\"0\" y=\"-2\" "
                                            "z=\"0\"/><rgb name=\"irradiance\" value=\"7\"/></emitter>");
    REQUIRE(scene.lights.size() == 3);
    CHECK(scene.lights[0].position == Vec3{1, 2, 3});
    CHECK(scene.lights[0].intensity == Rgb{4, 5, 6});
    CHECK(scene.lights[1].direction.z == doctest::Approx(-1));
    CHECK(scene.lights[1].position.z == doctest::Approx(5));
    REQUIRE(scene.lights[1].kind == LightKind::Goniometric);
    CHECK(scene.lights[1].table->last_angle == doctest::Approx(kPi / 6));
    const std::vector<float>& ramp = scene.lights[1].table->values.pixels; // linear from three quarters of the angle
    CHECK(ramp[3 * 768] == 1);
    CHECK(ramp[3 * 896] == doctest::Approx(0.5));
    CHECK(ramp[3 * 1024] == doctest::Approx(0).epsilon(1e-5));
    CHECK(scene.lights[2].direction == Vec3{0, -1, 0});
    CHECK(scene.lights[2].intensity == grey(7));
    Messages messages;
    (void)load_mitsuba_shapes(test::scratch_folder(),
                              shape_of("rectangle") + "<emitter type=\"timed_sunsky\"/><emitter type=\"spott\"/>",
                              messages);
    REQUIRE(messages.left_out().size() == 2);
    CHECK(messages.left_out()[1].find("did you mean \"spot\"?") != std::string::npos);
}

TEST_CASE("mitsuba: a projector shows its picture upright, with pi times its irradiance") {
    const fs::path folder = test::scratch_folder();
    Image wide{.width = 4, .height = 2, .channels = 3, .pixels = std::vector<float>(24, 1.0f)};
    wide.pixels[0] = 8; // red, upper left
    write_exr(folder / "picture.exr", wide);
    const std::string picture = "<texture type=\"bitmap\" name=\"{}\">" + named_file("picture.exr") +
                                "<string name=\"filter_type\" value=\"nearest\"/></texture>";
    const std::string look =
        "<transform name=\"to_world\"><lookat origin=\"0,0,5\" target=\"0,0,0\" up=\"0,1,0\"/></transform>";
    Messages messages;
    const Scene scene =
        load_mitsuba_shapes(folder,
                            shape_of("rectangle") +
                                "<emitter type=\"projector\"><float name=\"fov\" value=\"90\"/><float name=\"scale\" "
                                "value=\"0.5\"/>" +
                                fmt::format(fmt::runtime(picture), "irradiance") + look +
                                "</emitter>"
                                "<emitter type=\"spot\">" +
                                fmt::format(fmt::runtime(picture), "texture") + look +
                                "<float name=\"cutoff_angle\" value=\"45\"/></emitter>",
                            messages);
    CHECK(test::left_out_besides_backs(messages) == std::vector<std::string>{});
    REQUIRE(scene.lights.size() == 2);
    const Light& projector = scene.lights[0];
    CHECK(projector.direction.z == doctest::Approx(-1));
    CHECK(projector.up.y == doctest::Approx(1));
    CHECK_FALSE(projector.is_mirrored);
    CHECK(projector.intensity.r == doctest::Approx(4 * kPi));
    CHECK(projector.table->layout == TableLayout::PictureIrradiance);
    CHECK(projector.table->half_width == doctest::Approx(1));
    CHECK(projector.table->half_height == doctest::Approx(0.5));
    // The picture of a spot is turned by half a circle, square, and falls off in the angle.
    const Light& spot = scene.lights[1];
    CHECK(spot.up.y == doctest::Approx(-1));
    CHECK_FALSE(spot.is_mirrored);
    CHECK(spot.table->half_width == spot.table->half_height);
    const Image& values = spot.table->values;
    CHECK(*values.at(values.width / 2, values.height / 2) > 0.99f / 8);
    CHECK(*values.at(0, values.height / 2) == doctest::Approx(0).epsilon(0.01));
}

TEST_CASE("mitsuba: what a spot or a projector cannot have is left out with its line") {
    const fs::path folder = test::scratch_folder();
    Image slide{.width = 2, .height = 2, .channels = 3, .pixels = std::vector<float>(12, 1.0f)};
    slide.pixels[0] = slide.pixels[6] = 8; // the left column
    write_exr(folder / "slide.exr", slide);
    const auto bitmap = [](const char* name, const std::string& more) {
        return fmt::format("<texture type=\"bitmap\" name=\"{}\">{}{}</texture>", name, named_file("slide.exr"), more);
    };
    const auto wrapped = [&](const char* axis, const char* mode) {
        return bitmap("irradiance", fmt::format("<string name=\"wrap_mode{}\" value=\"{}\"/>", axis, mode));
    };
    struct Case {
        const char* type;
        std::string inside;
        const char* says; // empty: nothing is left out
    };
    for (const Case& c :
         {Case{"spot", "<float name=\"cutoff_angle\" value=\"120\"/>",
               "the cutoff_angle of 120 degrees is left out; 89.9 is used"},
          {"spot", "<float name=\"cutoff_angle\" value=\"90\"/>", ""},
          {"spot", "<float name=\"beam_width\" value=\"30\"/>", "the beam_width of 30 degrees"},
          {"spot", bitmap("texture", "<string name=\"wrap_mode\" value=\"repeat\"/>"), ""},
          {"spot", "<transform name=\"to_world\"><scale value=\"2\"/></transform>", ""},
          {"spot", "<transform name=\"to_world\"><scale y=\"2\"/></transform>", "the stretch of a light's transform"},
          {"projector", "<transform name=\"to_world\"><scale value=\"2\"/></transform>",
           "the scale of a projector's to_world"},
          {"projector", "<transform name=\"to_world\"><scale x=\"-1\"/></transform>", ""},
          {"projector", wrapped("", "repeat"), "the wrap mode repeat"},
          {"projector", wrapped("_u", "repeat"), "the wrap mode repeat"},
          {"projector", wrapped("_v", "repeat"), ""}, // its rows are equal
          {"projector", wrapped("", "mirror"), ""},
          {"projector", wrapped("", "clamp"), ""},
          {"projector", bitmap("irradiance", ""), ""}}) {
        CAPTURE(c.inside);
        Messages messages;
        const std::string emitter = fmt::format("<emitter type=\"{}\">{}</emitter>", c.type, c.inside);
        CHECK(load_mitsuba_shapes(folder, shape_of("rectangle") + emitter, messages).lights.size() == 1);
        const std::vector<std::string> said = messages.left_out();
        REQUIRE(said.size() == (*c.says != 0 ? 1 : 0));
        if (said.empty()) continue;
        CHECK(said[0].find(c.says) != std::string::npos);
        CHECK(said[0].find(".xml:") != std::string::npos);
    }
    slide.pixels[0] = 4; // the rows differ too
    write_exr(folder / "slide.exr", slide);
    Messages of_rows;
    (void)load_mitsuba_shapes(
        folder, shape_of("rectangle") + "<emitter type=\"projector\">" + wrapped("_v", "repeat") + "</emitter>",
        of_rows);
    REQUIRE(of_rows.left_out().size() == 1);
    CHECK(of_rows.left_out()[0].find("along v") != std::string::npos);
    CHECK(of_rows.all().size() == 2);
    slide.pixels[0] = 8;
    write_exr(folder / "slide.exr", slide);
    Messages messages; // the file does not ask for the other edge, so there is only a notice
    (void)load_mitsuba_shapes(
        folder, shape_of("rectangle") + "<emitter type=\"projector\">" + bitmap("irradiance", "") + "</emitter>",
        messages);
    REQUIRE(messages.all().size() == 1);
    CHECK(messages.all()[0].text.find("the wrap mode repeat") != std::string::npos);
    CHECK_FALSE(messages.all()[0].is_warning);
}

TEST_CASE("mitsuba: a constant emitter and an envmap are the environment") {
    const Scene constant = load_mitsuba_shapes(
        shape_of("rectangle") + "<emitter type=\"constant\"><rgb name=\"radiance\" value=\"2\"/></emitter>");
    REQUIRE(constant.environment);
    CHECK(constant.environment->scale == grey(2));
    const fs::path folder = test::scratch_folder();
    Image picture{.width = 8, .height = 4, .channels = 3, .pixels = {}};
    for (int i = 0; i < 32; ++i) {
        for (int c = 0; c < 3; ++c) picture.pixels.push_back(static_cast<float>(i % 8 == 2 || i % 8 == 1 ? 10 : 1));
    }
    write_image(folder / "sky.exr", picture);
    // The bright columns are at u = 0.25, which is +x for Mitsuba.
    const auto brightest = [&](const std::string& transform) {
        Messages messages;
        const Scene scene =
            load_mitsuba_shapes(folder,
                                shape_of("rectangle") + "<emitter type=\"envmap\">" + named_file("sky.exr") +
                                    "<float name=\"scale\" value=\"3\"/>" + transform + "</emitter>",
                                messages);
        const Image& image = scene.environment->image;
        CHECK(scene.environment->scale == grey(3));
        uint32_t most = 0;
        for (uint32_t x = 0; x + 1 < image.width; ++x) {
            const auto pair = [&](uint32_t at) {
                return image.pixels[3 * (image.width + at)] + image.pixels[3 * (image.width + at + 1)];
            };
            if (pair(x) > pair(most)) most = x;
        }
        return most + 1; // the border between the brightest two columns, of 8
    };
    // The upper rows differ: of our 12 rows the first, fourth and fifth are 1/8, 7/8 and 9/8 rows of Mitsuba's from its
    // first.
    for (std::size_t i = 0; i < 3 * 8; ++i) picture.pixels[i] = 0;
    write_image(folder / "rows.exr", picture);
    Messages messages;
    const Scene rows = load_mitsuba_shapes(
        folder, shape_of("rectangle") + "<emitter type=\"envmap\">" + named_file("rows.exr") + "</emitter>", messages);
    CHECK(rows.environment->image.height == 12);
    CHECK(rows.environment->image.pixels[0] == doctest::Approx(1 / 8.0));
    CHECK(rows.environment->image.pixels[3 * 8 * 3] == doctest::Approx(7 / 8.0));
    CHECK(rows.environment->image.pixels[3 * 8 * 4] == doctest::Approx(1));
    CHECK(brightest("") == 6); // +x is at three quarters of our panoramas
    CHECK(brightest("<transform name=\"to_world\"><rotate y=\"1\" angle=\"90\"/></transform>") == 4); // +x turns to -z
}

TEST_CASE("mitsuba: a serialized mesh whose triangles name no vertices of it is refused") {
    const std::string torn = serialized_file(4, {serialized_triangle(false, true, 1, 2)});
    CHECK(test::thrown_error([&] { (void)mitsuba::read_serialized(bytes_in(torn), 0, "m.serialized"); })->code() ==
          ErrorCode::BadInput);
}
