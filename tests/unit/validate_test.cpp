#include <doctest/doctest.h>

#include <functional>
#include <limits>

#include "scene/validate/validate.h"
#include "tests/support/thrown_error.h"

using namespace pertev;

namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// A unit square of two triangles, with every attribute, one material and one instance.
Scene square() {
    Scene scene;
    Mesh mesh;
    mesh.name = "square";
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    mesh.normals = std::vector<Vec3>(4, Vec3{0, 0, 1});
    mesh.tangents = std::vector<Vec4>(4, Vec4{1, 0, 0, 1});
    mesh.uv[0] = std::vector<Vec2>(4);
    mesh.colors = std::vector<Vec4>(4, Vec4{1, 1, 1, 1});
    mesh.indices = {0, 1, 2, 0, 2, 3};
    scene.meshes.push_back(mesh);
    scene.materials.emplace_back();
    scene.instances.push_back({.name = "one", .mesh = 0, .material = 0, .world_from_local = {}});
    return scene;
}

struct Result {
    Scene scene = square();
    Messages messages;
    std::optional<Error> error;
};

Result validated(const std::function<void(Scene&)>& change) {
    Result result;
    change(result.scene);
    result.error = test::thrown_error([&] { validate(result.scene, "file", result.messages); });
    return result;
}

void check_refused(const char* saying, ErrorCode code, const std::function<void(Scene&)>& change) {
    CAPTURE(saying);
    const Result result = validated(change);
    REQUIRE(result.error);
    CHECK(result.error->code() == code);
    CHECK(result.error->location() == FileLocation{"file"});
    CHECK_MESSAGE(test::says(result.error, saying), result.error->what());
}

} // namespace

TEST_CASE("a valid scene passes unchanged and without messages") {
    const Result result = validated([](Scene&) {});
    CHECK(!result.error);
    CHECK(result.messages.all().empty());
    CHECK(result.scene.meshes[0].indices == square().meshes[0].indices);
    CHECK(result.scene.meshes[0].normals == square().meshes[0].normals);
}

TEST_CASE("triangles with a vertex that is not finite, or without area, are dropped and counted") {
    const Result result = validated([](Scene& scene) {
        Mesh& mesh = scene.meshes[0];
        mesh.positions.push_back({kNan, 0, 0});
        mesh.positions.push_back({0, kInfinity, 0});
        mesh.positions.push_back({2, 2, 0}); // on the line from 0 to 2
        mesh.normals.resize(7, {0, 0, 1});
        mesh.tangents.resize(7, {1, 0, 0, 1});
        mesh.uv[0].resize(7);
        mesh.colors.resize(7);
        mesh.indices = {0, 1, 4, 0, 1, 2, 5, 4, 1, 1, 1, 2, 0, 2, 6, 0, 2, 3, 3, 3, 3};
    });
    REQUIRE(!result.error);
    const Mesh& mesh = result.scene.meshes[0];
    CHECK(mesh.indices == std::vector<uint32_t>{0, 1, 2, 0, 2, 3});
    for (const Vec3 p : mesh.positions) CHECK(is_finite(p));
    REQUIRE(result.messages.all().size() == 2);
    CHECK(result.messages.all()[0].text.starts_with("file: 2 triangles "));
    CHECK(result.messages.all()[1].text.starts_with("file: 3 triangles "));
}

TEST_CASE("tiny and huge triangles have an area") {
    for (const float scale : {0x1p-70f, 0x1p39f}) {
        const Result result = validated([&](Scene& scene) {
            for (Vec3& p : scene.meshes[0].positions) p = scale * p;
        });
        REQUIRE(!result.error);
        CHECK(result.scene.meshes[0].triangle_count() == 2);
    }
}

TEST_CASE("a mesh without valid triangles is dropped with its instances, and a scene without any is refused") {
    const Result result = validated([](Scene& scene) {
        scene.meshes.insert(scene.meshes.begin(), scene.meshes[0]);
        scene.meshes[0].indices = {0, 0, 0};
        scene.instances.push_back({.name = "two", .mesh = 1, .material = 0, .world_from_local = {}});
    });
    REQUIRE(!result.error);
    CHECK(result.scene.meshes.size() == 1);
    REQUIRE(result.scene.instances.size() == 1);
    CHECK(result.scene.instances[0].name == "two");
    CHECK(result.scene.instances[0].mesh == 0);

    check_refused("", ErrorCode::BadInput, [](Scene& scene) { scene.meshes[0].indices = {0, 0, 0}; });
    check_refused("", ErrorCode::BadInput, [](Scene& scene) { scene = {}; });
}

TEST_CASE("an instance hidden by a scale of 0 is left out with a warning; if all are, an error explains that") {
    const auto add_hidden = [](Scene& scene, uint32_t node) {
        scene.instances.push_back({.name = "hidden", .world_from_local = make_scale({0, 0, 0}), .node = node});
    };
    const Result result = validated([&](Scene& scene) {
        scene.nodes.resize(7);
        add_hidden(scene, 5);
        scene.instances.push_back({.name = "last", .mesh = 0, .material = 0, .world_from_local = {}});
        add_hidden(scene, 6);
    });
    REQUIRE(!result.error);
    REQUIRE(result.scene.instances.size() == 2);
    CHECK(result.scene.instances[0].name == "one");
    CHECK(result.scene.instances[1].name == "last");
    REQUIRE(result.messages.all().size() == 1);
    CHECK(result.messages.all()[0].text.starts_with("file: 2 instances "));
    CHECK(result.messages.all()[0].text.find("/nodes/5 hidden") != std::string::npos);

    check_refused("/nodes/5 hidden", ErrorCode::BadInput, [&](Scene& scene) {
        scene.instances.clear();
        scene.nodes.resize(7);
        add_hidden(scene, 5);
    });
}

TEST_CASE("an instance that is out of bounds or has a singular transform is left out if others remain") {
    const auto add = [](Scene& scene, const Transform& place) {
        scene.instances.push_back({.name = "odd", .mesh = 0, .material = 0, .world_from_local = place});
    };
    for (const Transform& place : {make_scale({1e30f, 1, 1}), make_scale({kInfinity, 1, 1}), make_scale({1, 0, 1})}) {
        const Result result = validated([&](Scene& scene) { add(scene, place); });
        REQUIRE(!result.error);
        CHECK(result.scene.instances.size() == 1);
        REQUIRE(result.messages.left_out().size() == 1);
        CHECK(result.messages.left_out()[0].find("odd") != std::string::npos);
    }
    const Result hidden = validated([&](Scene& scene) { add(scene, make_scale({0, 0, 1})); });
    CHECK(hidden.scene.instances.size() == 1);
    CHECK(hidden.messages.left_out().empty());
}

TEST_CASE("an error for a scene without geometry lists its content") {
    check_refused("mesh 0 square", ErrorCode::BadInput, [](Scene& scene) { scene.meshes[0].indices = {0, 0, 0}; });
    check_refused("as the reader says", ErrorCode::BadInput, [](Scene& scene) {
        scene = {};
        scene.no_instances = "as the reader says";
    });
}

TEST_CASE("every parameter of a material is visited and thus checked") {
    MaterialParameters parameters;
    std::size_t bytes =
        sizeof parameters.two_sided_emission + sizeof parameters.double_sided + sizeof parameters.is_clear_boundary;
    visit_choices(parameters, [&](auto& value, auto&&...) { bytes += sizeof value; });
    bytes += (alignof(float) - bytes % alignof(float)) % alignof(float); // floats follow
    bytes += alignof(float);                                             // for thin_walled and what follows it
    visit_parameters(
        parameters, [&](float& value, auto&&...) { bytes += sizeof value; },
        [&](const TextureRef& texture, auto&&...) { bytes += sizeof texture; });
    CHECK(bytes == sizeof parameters);
}

TEST_CASE("messages name elements by their location in the file") {
    using E = ErrorCode;
    check_refused("file: /meshes/3/primitives/1 square: triangle 1", E::BadInput, [](Scene& s) {
        s.meshes[0].origin = "/meshes/3/primitives/1";
        s.meshes[0].indices[4] = 4;
    });
    check_refused("file: /nodes/7 one lies beyond", E::OverLimit, [](Scene& s) {
        s.nodes.resize(8);
        s.instances[0].node = 7;
        s.instances[0].world_from_local = make_scale({1e30f, 1, 1});
    });
    check_refused("file: /materials/2: ior is", E::BadInput, [](Scene& s) {
        s.materials[0].origin = "/materials/2";
        s.materials[0].ior = kNan;
    });
    check_refused("file: /nodes/4 lamp: its range", E::BadInput, [](Scene& s) {
        s.lights.emplace_back().name = "lamp";
        s.lights[0].origin = "/nodes/4";
        s.lights[0].range = -1;
    });
    check_refused("file: /nodes/4: its focus distance", E::BadInput, [](Scene& s) {
        s.cameras.emplace_back().origin = "/nodes/4";
        s.cameras[0].focus_distance = 0;
    });
}

TEST_CASE("normals are normalised; zero and NaN become the geometric normal") {
    const Result result = validated([](Scene& scene) {
        Mesh& mesh = scene.meshes[0];
        mesh.normals = {{0, 0, 0}, {kNan, 0, 1}, {3e30f, 4e30f, 0}, {0, 0, 1e-30f}};
        mesh.tangents[0] = {0, 0, 0, -3};
        mesh.uv[0][1] = {kNan, 0};
        mesh.colors[2] = {2, kNan, 0.5f, 1};
    });
    REQUIRE(!result.error);
    const Mesh& mesh = result.scene.meshes[0];
    CHECK(mesh.normals[0] == Vec3{0, 0, 1});
    CHECK(mesh.normals[1] == Vec3{0, 0, 1});
    CHECK(mesh.normals[2].x == doctest::Approx(0.6));
    CHECK(mesh.normals[2].y == doctest::Approx(0.8));
    CHECK(mesh.normals[3] == Vec3{0, 0, 1});
    CHECK(mesh.tangents[0].w == -1);
    CHECK(length(Vec3{mesh.tangents[0].x, mesh.tangents[0].y, mesh.tangents[0].z}) == doctest::Approx(1));
    CHECK(mesh.uv[0][1] == Vec2{});
    CHECK(mesh.colors[2] == Vec4{1, 0, 0.5f, 1});
    CHECK(result.messages.all().size() == 4);
}

TEST_CASE("faults of meshes and instances are refused with their location") {
    using E = ErrorCode;
    check_refused("triangle 1: vertex index 4", E::BadInput, [](Scene& s) { s.meshes[0].indices[4] = 4; });
    check_refused("5 indices", E::BadInput, [](Scene& s) { s.meshes[0].indices.pop_back(); });
    check_refused("3 normals for 4", E::BadInput, [](Scene& s) { s.meshes[0].normals.pop_back(); });
    check_refused("3 texture", E::BadInput, [](Scene& s) { s.meshes[0].uv[0].pop_back(); });
    check_refused("2^40", E::OverLimit, [](Scene& s) {
        for (Vec3& p : s.meshes[0].positions) p.x += 0x1.1p40f;
    });
    check_refused("mesh 1 is out", E::BadInput, [](Scene& s) { s.instances[0].mesh = 1; });
    check_refused("material 7 is out", E::BadInput, [](Scene& s) { s.instances[0].material = 7; });
    check_refused("singular", E::BadInput, [](Scene& s) { s.instances[0].world_from_local = make_scale({1, 0, 1}); });
    check_refused("not finite", E::BadInput, [](Scene& s) { s.instances[0].world_from_local.translation.y = kNan; });
    check_refused("2^40", E::OverLimit, [](Scene& s) { s.instances[0].world_from_local = make_scale({1e30f, 1, 1}); });
    check_refused("2^40", E::OverLimit, [](Scene& s) { s.instances[0].world_from_local.translation.z = 1e13f; });
}

TEST_CASE("faults of materials and images are refused, and numbers out of range are clamped with one warning") {
    using E = ErrorCode;
    check_refused("base_color is", E::BadInput, [](Scene& s) { s.materials[0].base_color.g = kNan; });
    check_refused("emission is", E::BadInput, [](Scene& s) { s.materials[0].emission.r = kInfinity; });
    check_refused("ior is", E::BadInput, [](Scene& s) { s.materials[0].ior = kNan; });
    check_refused("image 0 is out", E::BadInput, [](Scene& s) { s.materials[0].normal_texture.image = 0; });
    check_refused("image -2 is out", E::BadInput, [](Scene& s) { s.materials[0].alpha_texture.image = -2; });
    check_refused("no pixels", E::BadInput, [](Scene& s) { s.images.emplace_back(); });
    check_refused("15 values", E::BadInput, [](Scene& s) {
        s.images.emplace_back().rgba8 = {.width = 2, .height = 2, .pixels = std::vector<uint8_t>(15)};
    });
    const auto with_image = [](Scene& s) {
        s.images.emplace_back().rgba8 = {.width = 2, .height = 2, .pixels = std::vector<uint8_t>(16)};
        s.materials[0].base_color_texture.image = 0;
    };
    CHECK(!validated(with_image).error);
    check_refused("transform", E::BadInput, [&](Scene& s) {
        with_image(s);
        s.materials[0].base_color_texture.m01 = kNan;
    });
    check_refused("set 4", E::BadInput, [&](Scene& s) {
        with_image(s);
        s.materials[0].base_color_texture.uv_set = 4;
    });

    const Result clamped = validated([](Scene& s) {
        s.materials[0].base_color = {1.5f, 0.5f, -1};
        s.materials[0].emission.b = -2;
        s.materials[0].ior = 0;
    });
    REQUIRE(!clamped.error);
    CHECK(clamped.scene.materials[0].base_color == Rgb{1, 0.5f, 0});
    CHECK(clamped.scene.materials[0].emission == Rgb{0, 0, 0});
    CHECK(clamped.scene.materials[0].ior == kLeastIor);
    REQUIRE(clamped.messages.all().size() == 1);
    CHECK(clamped.messages.all()[0].text.starts_with("file: 4 numbers"));
}

TEST_CASE("faults of cameras and lights are refused") {
    using E = ErrorCode;
    const auto camera = [](auto change) { return [change](Scene& s) { change(s.cameras.emplace_back()); }; };
    CHECK(!validated(camera([](Camera&) {})).error);
    check_refused("field of view", E::BadInput, camera([](Camera& c) { c.fov_y = 0; }));
    check_refused("field of view", E::BadInput, camera([](Camera& c) { c.fov_y = 3.2f; }));
    check_refused("singular", E::BadInput, camera([](Camera& c) { c.world_from_camera = make_scale({0, 1, 1}); }));
    check_refused("aperture", E::BadInput, camera([](Camera& c) { c.aperture_radius = kNan; }));
    check_refused("2 blades", E::BadInput, camera([](Camera& c) { c.aperture.blades = 2; }));
    check_refused("101 blades", E::BadInput, camera([](Camera& c) { c.aperture.blades = 101; }));
    check_refused("rotated", E::BadInput, camera([](Camera& c) { c.aperture.rotation_deg = kNan; }));
    check_refused("ratio", E::BadInput, camera([](Camera& c) { c.aperture.ratio = 0; }));
    check_refused("focus", E::BadInput, camera([](Camera& c) { c.focus_distance = 0; }));
    check_refused("aspect", E::BadInput, camera([](Camera& c) { c.aspect = -1; }));
    check_refused("2^40", E::OverLimit, camera([](Camera& c) { c.world_from_camera.translation.x = 1e20f; }));
    check_refused("height", E::BadInput, camera([](Camera& c) { c.ortho_height = kNan; }));
    check_refused("height", E::BadInput, camera([](Camera& c) {
                      c.projection = Projection::Orthographic;
                      c.ortho_height = 0;
                  }));

    const auto light = [](auto change) {
        return [change](Scene& s) {
            s.lights.emplace_back().kind = LightKind::Spot;
            change(s.lights[0]);
        };
    };
    CHECK(!validated(light([](Light&) {})).error);
    check_refused("intensity", E::BadInput, light([](Light& l) { l.intensity.g = -1; }));
    check_refused("intensity", E::BadInput, light([](Light& l) { l.intensity.g = kNan; }));
    check_refused("direction", E::BadInput, light([](Light& l) { l.direction = {}; }));
    check_refused("cone", E::BadInput, light([](Light& l) { l.cos_outer = l.cos_inner; }));
    check_refused("range", E::BadInput, light([](Light& l) { l.range = -1; }));
    check_refused("2^40", E::OverLimit, light([](Light& l) { l.position.x = kInfinity; }));
    CHECK(validated(light([](Light& l) { l.direction = {0, 0, 8}; })).scene.lights[0].direction == Vec3{0, 0, 1});
}

TEST_CASE("an environment's pixels that are negative or not finite are set to 0 and counted") {
    const Result result = validated([](Scene& s) {
        s.environment.emplace().image = {
            .width = 2, .height = 1, .channels = 3, .pixels = {1, -1, kNan, 2, kInfinity, 3}};
    });
    REQUIRE(!result.error);
    CHECK(result.scene.environment->image.pixels == std::vector<float>{1, 0, 0, 2, 0, 3});
    CHECK(result.messages.all().size() == 1);
    check_refused("scale", ErrorCode::BadInput, [](Scene& s) { s.environment.emplace().scale.r = -1; });
}

TEST_CASE("messages use names where there are any, numbers otherwise, and the right plural") {
    const auto out_of_range = [](Scene& scene) { scene.meshes[0].indices[3] = 9; };
    check_refused("file: mesh 0 square: triangle 1: ", ErrorCode::BadInput, out_of_range);
    check_refused("file: mesh 0: triangle 1: ", ErrorCode::BadInput, [&](Scene& scene) {
        scene.meshes[0].name.clear();
        out_of_range(scene);
    });
    const Result result = validated([](Scene& scene) { scene.meshes[0].indices[1] = 0; });
    REQUIRE(result.messages.all().size() == 1);
    CHECK(result.messages.all()[0].text.starts_with("file: 1 triangle "));
}
