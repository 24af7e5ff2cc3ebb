// Scenes far from the origin of their files: positions that are read, transformed and printed keep the file's
// precision.

#include "scene/scene_origin.h"

#include <cmath>
#include <cstring>

#include <doctest/doctest.h>
#include <fmt/format.h>

#include "base/limits.h"
#include "device_scene/place_meshes.h"
#include "formats/obj/parse_obj.h"
#include "formats/read_scene.h"
#include "scene/pose/posed_scene.h"
#include "scene/position_bounds.h"
#include "session/measure_irradiance.h"
#include "session/opening/moving_camera.h"
#include "session/writing/picture_metadata.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"
#include "tests/support/thrown_error.h"
#include "tests/support/write_text.h"

using namespace pertev;

namespace scene_origin_test { // test files are compiled together

constexpr double kEast = 448262.257, kNorth = 5411933.125; // metres of UTM

Scene load(const std::string& name, const std::string& bytes) {
    Messages messages;
    return read_scene(test::write_text(test::scratch_folder() / name, bytes), {}, messages);
}

/// A square of 1 m with its lower left corner at that point.
std::string square_obj(double x, double y, const std::string& before = "") {
    return before +
           fmt::format("v {:.4f} {:.4f} 0\nv {:.4f} {:.4f} 0\nv {:.4f} {:.4f} 0\nv {:.4f} {:.4f} 0\n", x, y, x + 1, y,
                       x + 1, y + 1, x, y + 1) +
           "f -4 -3 -2 -1\n";
}

/// Returns the distance of the scene's point `p` from (x, y, z) in the file's coordinates, metres.
double off(const Scene& scene, Vec3 p, DoubleVec3 wanted) {
    const DoubleVec3 d = in_file(scene, p) - wanted;
    return std::sqrt(dot(d, d));
}

Vec3 placed(const Scene& scene, std::size_t instance, std::size_t vertex) {
    const Instance& i = scene.instances.at(instance);
    return transform_point(i.world_from_local, scene.meshes[i.mesh].positions.at(vertex));
}

template <class Number>
std::string binary_square(const char* type, double x, double y) {
    std::string bytes = fmt::format("ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty {0} x\n"
                                    "property {0} y\nproperty {0} z\nelement face 1\n"
                                    "property list uchar int vertex_indices\nend_header\n",
                                    type);
    const auto add = [&](auto value) { bytes.append(reinterpret_cast<const char*>(&value), sizeof value); };
    for (const double corner : {0.0, 1.0, 2.0}) {
        add(static_cast<Number>(corner == 1.0 ? x + 1 : x));
        add(static_cast<Number>(corner == 2.0 ? y + 1 : y));
        add(static_cast<Number>(0));
    }
    add(uint8_t(3));
    for (const int32_t index : {0, 1, 2}) add(index);
    return bytes;
}

/// A triangle of 1 m at its mesh's origin, with these nodes and additional members.
std::string far_gltf(const std::string& nodes, const std::string& more = "") {
    test::GltfBuilder builder;
    builder.add("VEC3", std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0});
    builder.add("VEC3", std::vector<float>{0, 0, 0, 0.5f, 0, 0}); // translations of instances and of keys
    builder.add("SCALAR", std::vector<float>{0, 1});
    return builder.json(R"("scenes":[{"nodes":[0]}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],)"
                        R"("nodes":[)" +
                        nodes + "]" + more);
}

/// Returns the camera made from the flags in this camera's metadata.
Camera reopened(const CameraSource& source, const Scene& scene) {
    CameraChoice choice;
    for (const auto& [key, value] : camera_metadata(source)) {
        const std::string* text = std::get_if<std::string>(&value);
        double x = 0, y = 0, z = 0;
        if (text == nullptr || std::sscanf(text->c_str(), "%lf,%lf,%lf", &x, &y, &z) != 3) continue;
        if (key == "pertev.eye") choice.eye = DoubleVec3{x, y, z};
        if (key == "pertev.target") choice.target = DoubleVec3{x, y, z};
        if (key == "pertev.up") choice.up = to_float(DoubleVec3{x, y, z});
    }
    REQUIRE(choice.eye);
    REQUIRE(choice.target);
    Messages messages;
    return choose_camera(choice, scene, 1, messages);
}

TEST_CASE(
    "the origin is 0 for a scene around the file's origin, otherwise the centre of its box on a grid of its size") {
    CHECK(origin_for({}) == DoubleVec3{0, 0, 0});
    CHECK(origin_for({{-1, -1, -1}, {2, 2, 2}}) == DoubleVec3{0, 0, 0});
    CHECK(origin_for({{1e6 + 3.25, -7, 0}, {1e6 + 6.25, -5, 1}}) == DoubleVec3{1e6 + 4, -8, 0});
    CHECK(origin_for({{0x1p41, 0, 0}, {0x1p41, 1, 0}}) == DoubleVec3{0, 0, 0}); // refused in the file's coordinates
    Scene scene;
    set_origin({{4097, 0, 0}, {4098, 1, 1}}, scene);
    CHECK(scene.is_far);
    set_origin({{4094, 0, 0}, {4095, 1, 1}}, scene);
    CHECK(scene.origin_in_file == DoubleVec3{4095, 1, 1});
    CHECK(!scene.is_far);
}

TEST_CASE("sampled points prove that an origin is unchanged only if their box is unchanged") {
    CHECK(surely_stays({{-1, 0, 0}, {1, 2, 0}}));
    CHECK(surely_stays({{61, 0, 0}, {62, 1, 0}}));
    CHECK(!surely_stays({{62, 0, 0}, {63, 1, 0}}));
    CHECK(!surely_stays({}));
    for (float side = 1; side < 8; side += 0.37f) { // the box contains the sample and other points
        const Bounds3 box = {{62 - side, -side, 0}, {62, 1, 0}};
        if (surely_stays({{61, 0, 0}, {62, 1, 0}})) CHECK(origin_for(double_box_of(box)) == DoubleVec3{0, 0, 0});
    }
}

TEST_CASE("an OBJ file far from the origin keeps its digits, and a near one is unchanged") {
    const Scene far = load("far.obj", square_obj(kEast, kNorth, "v 0 0 0\n")); // a vertex without a face does not count
    CHECK(far.is_far);
    CHECK(off(far, placed(far, 0, 0), {kEast, kNorth, 0}) < 1e-7);
    CHECK(off(far, placed(far, 0, 2), {kEast + 1, kNorth + 1, 0}) < 1e-7);
    CHECK(world_centre(far) == Vec3{0, 0, 0});

    const Scene near = load("near.obj", square_obj(0.3, -0.7));
    CHECK(near.origin_in_file == DoubleVec3{0, 0, 0});
    CHECK(!near.is_far);
    CHECK(near.meshes[0].positions[0] == Vec3{0.3f, -0.7f, 0});
    const Scene between = load("between.obj", square_obj(100.25, 0));
    CHECK(between.origin_in_file == DoubleVec3{101, 1, 0});
    CHECK(!between.is_far);
    CHECK(placed(between, 0, 0).x == -0.75f);
}

TEST_CASE("far positions of an OBJ file do not depend on how its text is split among threads") {
    std::string text;
    for (int i = 0; i < 50; ++i) text += square_obj(kEast + i, kNorth, i % 7 == 0 ? "v 1 nan 2\n# v 7 7 7\n" : "");
    const auto parse = [&](std::size_t piece_bytes) {
        Messages messages;
        return parse_obj(std::as_bytes(std::span(text)), "a.obj", messages, {}, piece_bytes);
    };
    const ObjData whole = parse(1 << 20), pieces = parse(64);
    REQUIRE(whole.positions.size() == 208);
    CHECK(whole.box.lo == pieces.box.lo);
    CHECK(std::memcmp(whole.positions.data(), pieces.positions.data(), 208 * sizeof(Vec3)) == 0);
    CHECK(std::isnan(whole.positions[0].y));
    CHECK(std::abs(static_cast<double>(whole.positions[207].x) + origin_for(whole.box).x - (kEast + 49)) < 1e-5);
}

TEST_CASE("a concave polygon far from the origin is triangulated as at the origin") {
    const auto polygon = [](double x, double y) {
        const auto v = [&](double dx, double dy) { return fmt::format("v {:.3f} {:.3f} 0\n", x + dx, y + dy); };
        return v(0, 0) + v(.4, .1) + v(.8, 0) + v(.4, .3) + "f 1 2 3 4\n";
    };
    CHECK(load("far.obj", polygon(kEast, kNorth)).meshes.at(0).indices ==
          load("near.obj", polygon(0, 0)).meshes.at(0).indices);
}

TEST_CASE("a PLY file far from the origin keeps the digits of doubles and text, and floats are unchanged") {
    for (const char* type : {"double", "float"}) {
        CAPTURE(type);
        const Scene text =
            load("text.ply", fmt::format("ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int "
                                         "vertex_indices\nelement vertex 4\nproperty {0} x\nproperty {0} y\nproperty "
                                         "{0} z\nend_header\n3 1 2 3\n0 0 0\n{1:.4f} {2:.4f} 0\n{3:.4f} {2:.4f} "
                                         "0\n{1:.4f} {4:.4f} 0\n",
                                         type, kEast, kNorth, kEast + 1, kNorth + 1));
        CHECK(text.is_far);
        CHECK(off(text, text.meshes.at(0).positions[1], {kEast, kNorth, 0}) < 1e-7);
    }
    const Scene doubles = load("doubles.ply", binary_square<double>("double", kEast, kNorth));
    CHECK(doubles.is_far);
    CHECK(off(doubles, placed(doubles, 0, 0), {kEast, kNorth, 0}) < 1e-7);
    CHECK(off(doubles, placed(doubles, 0, 2), {kEast, kNorth + 1, 0}) < 1e-7);
    const Scene floats = load("floats.ply", binary_square<float>("float", kEast, kNorth));
    CHECK(off(floats, placed(floats, 0, 0), {448262.25, 5411933, 0}) == 0);
    const Scene near = load("near.ply", binary_square<float>("float", 0.3, -0.7));
    CHECK(near.origin_in_file == DoubleVec3{0, 0, 0});
    CHECK(near.meshes[0].positions[0] == Vec3{0.3f, -0.7f, 0});
}

TEST_CASE("a chain of far, rotated and returning glTF nodes is composed in double") {
    const Scene far = test::read_gltf_text(far_gltf(R"({"translation":[448262.257,5411933.125,10],"children":[1]},)"
                                                    R"({"mesh":0,"translation":[0.125,0.25,0.0625],"scale":[2,2,2]})"));
    CHECK(far.is_far);
    CHECK(off(far, placed(far, 0, 0), {kEast + 0.125, kNorth + 0.25, 10.0625}) < 1e-6);
    CHECK(off(far, placed(far, 0, 1), {kEast + 2.125, kNorth + 0.25, 10.0625}) < 1e-6);

    // z points up, as in survey data. A quarter turn about x takes (x, y, z) to (x, z, -y).
    const Scene turned =
        test::read_gltf_text(far_gltf(R"({"rotation":[-0.7071067811865475,0,0,0.7071067811865476],"children":[1]},)"
                                      R"({"mesh":0,"translation":[448262.257,5411933.125,10]})"));
    CHECK(off(turned, placed(turned, 0, 0), {kEast, 10, -kNorth}) < 1e-6);

    const Scene back = test::read_gltf_text(far_gltf(R"({"translation":[448262.257,5411933.125,0],"children":[1]},)"
                                                     R"({"mesh":0,"translation":[-448262.007,-5411933,0]})"));
    CHECK(back.origin_in_file == DoubleVec3{0, 0, 0});
    CHECK(length(placed(back, 0, 0) - Vec3{0.25f, 0.125f, 0}) < 1e-6f);

    const Scene matrix = test::read_gltf_text(
        far_gltf(R"({"matrix":[1,0,0,0, 0,1,0,0, 0,0,1,0, 448262.257,5411933.125,0,1],"children":[1]},)"
                 R"({"mesh":0,"translation":[0.25,0,0]})"));
    CHECK(off(matrix, placed(matrix, 0, 0), {kEast + 0.25, kNorth, 0}) < 1e-6);
}

TEST_CASE("instances, cameras, lights and skins of far glTF nodes keep their positions") {
    const Scene scene = test::read_gltf_text(
        far_gltf(R"({"translation":[448262.257,5411933.125,0],"children":[1,2,3]},)"
                 R"({"mesh":0,"extensions":{"EXT_mesh_gpu_instancing":{"attributes":{"TRANSLATION":1}}}},)"
                 R"({"camera":0,"translation":[0.5,0.25,4]},)"
                 R"({"translation":[0,2.125,0],"extensions":{"KHR_lights_punctual":{"light":0}}})",
                 R"(,"extensionsUsed":["EXT_mesh_gpu_instancing","KHR_lights_punctual"],)"
                 R"("extensions":{"KHR_lights_punctual":{"lights":[{"type":"point"}]}},)"
                 R"("cameras":[{"type":"perspective","perspective":{"yfov":1,"znear":0.1}}])"));
    REQUIRE(scene.instances.size() == 2);
    CHECK(off(scene, placed(scene, 0, 0), {kEast, kNorth, 0}) < 1e-6);
    CHECK(off(scene, placed(scene, 1, 0), {kEast + 0.5, kNorth, 0}) < 1e-6);
    CHECK(off(scene, scene.cameras.at(0).world_from_camera.translation, {kEast + 0.5, kNorth + 0.25, 4}) < 1e-6);
    CHECK(off(scene, scene.lights.at(0).position, {kEast, kNorth + 2.125, 0}) < 1e-6);

    test::GltfBuilder builder;
    builder.add("VEC3", std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0});
    builder.add("VEC4", std::vector<uint8_t>{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0});
    builder.add("VEC4", std::vector<float>{1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0});
    const Scene skinned = test::read_gltf_text(
        builder.json(R"("scenes":[{"nodes":[0]}],"skins":[{"joints":[2]}],)"
                     R"("meshes":[{"primitives":[{"attributes":{"POSITION":0,"JOINTS_0":1,"WEIGHTS_0":2}}]}],)"
                     R"("nodes":[{"translation":[448262.257,5411933.125,0],"children":[1,2]},{"mesh":0,"skin":0},)"
                     R"({"translation":[0.25,0,0]}])"));
    CHECK(skinned.is_far);
    CHECK(off(skinned, placed(skinned, 0, 0), {kEast + 0.25, kNorth, 0}) < 1e-6);
    CHECK(off(skinned, placed(skinned, 0, 2), {kEast + 0.25, kNorth + 1, 0}) < 1e-6);
}

TEST_CASE("children of a far node move as at the origin") {
    Messages messages;
    const std::string animation = R"(,"animations":[{"samplers":[{"input":2,"output":1}],)"
                                  R"("channels":[{"sampler":0,"target":{"node":1,"path":"translation"}}]}],)"
                                  R"("cameras":[{"type":"perspective","perspective":{"yfov":1,"znear":0.1}}])";
    const std::string nodes = R"({"translation":[448262.257,5411933.125,0],"children":[1]},)"
                              R"({"mesh":0,"camera":0})";
    PosedScene posed(test::read_gltf_text(far_gltf(nodes, animation)));
    for (const double time_s : {0.0, 0.25, 1.0, 0.5}) {
        CAPTURE(time_s);
        posed.set_time(time_s);
        const Scene& now = posed.scene();
        CHECK(off(now, placed(now, 0, 0), {kEast + 0.5 * time_s, kNorth, 0}) < 1e-6);
        CHECK(off(now, now.cameras[0].world_from_camera.translation, {kEast + 0.5 * time_s, kNorth, 0}) < 1e-6);
        const auto placements = posed.placements_at(time_s + 0.125);
        REQUIRE(placements.instances[0]);
        CHECK(off(now, placements.instances[0]->translation, {kEast + 0.5 * std::min(1.0, time_s + 0.125), kNorth, 0}) <
              1e-6);
    }
}

TEST_CASE("a far animated node is between its keys at every time") {
    test::GltfBuilder builder;
    builder.add("VEC3", std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0});
    builder.add("VEC3", std::vector<float>{448262, 5411933, 0, 448263, 5411933, 0});
    builder.add("SCALAR", std::vector<float>{0, 1});
    PosedScene posed(test::read_gltf_text(builder.json(
        R"("scenes":[{"nodes":[0]}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],)"
        R"("nodes":[{"mesh":0,"translation":[448262,5411933,0]}],"animations":[{"samplers":[{"input":2,"output":1}],)"
        R"("channels":[{"sampler":0,"target":{"node":0,"path":"translation"}}]}])")));
    for (const double time_s : {0.0, 0.3, 0.7001, 1.0}) {
        CAPTURE(time_s);
        posed.set_time(time_s);
        CHECK(off(posed.scene(), placed(posed.scene(), 0, 0), {448262 + time_s, 5411933, 0}) < 1e-6);
    }
}

TEST_CASE("the metadata of a camera far from the origin reproduces it to the bit") {
    const Scene scene = load("far.obj", square_obj(kEast, kNorth));
    Messages messages;
    const DoubleVec3 eye = {448262.757, 5411933.5625, 5};
    CameraChoice flags = {.eye = eye, .target = DoubleVec3{448262.757, 5411933.5625, 0.001}};
    const Camera requested = choose_camera(flags, scene, 1, messages);
    CHECK(off(scene, requested.world_from_camera.translation, eye) < 1e-6);
    const CameraSource source = source_of(flags, requested, scene.origin_in_file);
    CHECK(reopened(source, scene).world_from_camera == requested.world_from_camera);

    const Camera made_up = choose_camera({}, scene, 1, messages);
    const Camera again = reopened(source_of(CameraChoice{}, made_up, scene.origin_in_file), scene);
    CHECK(again.world_from_camera.translation == made_up.world_from_camera.translation);
    CHECK(length(column(again.world_from_camera, 2) - column(made_up.world_from_camera, 2)) < 1e-6f);

    const Camera aimed = choose_camera({.eye = eye}, scene, 1, messages); // at the centre, as in the notice
    CHECK(off(scene, aimed.world_from_camera.translation - column(aimed.world_from_camera, 2) * 5.0f,
              {kEast + 0.5, kNorth + 0.5, 0}) < 0.1);
    CHECK(messages.all().back().text.find("`eye=448262.757,5411933.5625,5` `target=448262.757") != std::string::npos);
}

TEST_CASE("a camera's path and a meter are in the coordinates of the file, in double") {
    const Scene scene = load("far.obj", square_obj(kEast, kNorth));
    const DoubleVec3 eye = {kEast, kNorth, 5}, next = {kEast + 0.001, kNorth, 5};
    Messages messages;
    const CameraPath path = {{{.time_s = 0, .eye = eye, .target = {kEast, kNorth, 0}},
                              {.time_s = 2, .eye = next, .target = {kEast, kNorth, 0}}}};
    const MovingCamera moving({}, path, scene, 1, messages);
    CHECK(off(scene, moving.at(scene, 1.0).world_from_camera.translation, {kEast + 0.0005, kNorth, 5}) < 1e-6);
    const Camera meter = meter_camera(scene, {{kEast + 0.25, kNorth, 0}, {0, 0, 1}});
    CHECK(off(scene, meter.world_from_camera.translation, {kEast + 0.25, kNorth, 0}) < 1e-5);
}

TEST_CASE("the position layer is in the file's coordinates, and relative to the origin of a far scene") {
    struct Case {
        double x, y;
        bool is_far;
    };
    for (const Case c : {Case{0.25, 0.5, false}, Case{100.25, -3000, false}, Case{kEast, kNorth, true}}) {
        CAPTURE(c.x);
        const Scene scene = load("square.obj", square_obj(c.x, c.y));
        CHECK(scene.is_far == c.is_far);
        Messages messages;
        const CameraChoice choice = {.eye = DoubleVec3{c.x + 0.5, c.y + 0.5, 3},
                                     .target = DoubleVec3{c.x + 0.5, c.y + 0.5, 0},
                                     .projection = Projection::Orthographic,
                                     .view_height = 1e-4f};
        RenderSettings settings;
        settings.width = settings.height = 1;
        settings.samples = 1;
        settings.filter = PixelFilter::Box;
        settings.filter_radius = 0;
        settings.aovs = kAovPosition;
        Queue queue = test::requested_queue();
        const RenderResult result = test::render(queue, scene, choose_camera(choice, scene, 1, messages), settings);
        const float* at = result.layers.at(0).image.pixels.data();
        const SceneSource source = source_of(SceneOptions{}, scene);
        CHECK(source.position_origin.has_value() == c.is_far);
        const DoubleVec3 origin = source.position_origin.value_or(DoubleVec3{0, 0, 0});
        CHECK(std::abs(origin.x + static_cast<double>(at[0]) - (c.x + 0.5)) < 1e-4);
        CHECK(std::abs(origin.y + static_cast<double>(at[1]) - (c.y + 0.5)) < 3e-4);
        if (c.is_far) CHECK(std::abs(at[0]) < 2);
    }
}

TEST_CASE("positions beyond 2^40 m are refused for any origin") {
    const std::string beyond = "v 4e12 0 0\nv 4.1e12 0 0\nv 4e12 1e11 0\nf 1 2 3\n";
    CHECK(test::says(test::thrown_error([&] { load("beyond.obj", beyond); }), "2^40"));
}

} // namespace scene_origin_test
