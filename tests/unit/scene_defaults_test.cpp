#include <doctest/doctest.h>

#include <algorithm>
#include <array>

#include "formats/read_scene.h"
#include "math/portable_math.h"
#include "session/survey/cast_rays.h"
#include "session/survey/default_camera.h"
#include "session/survey/default_light.h"
#include "session/survey/surroundings.h"
#include "tests/support/options.h"
#include "tests/support/random.h"

using namespace pertev;

namespace {

/// The sides of a box as one instance. `sides` selects from -x, +x, -y, +y, -z and +z.
void add_box(Scene& scene, Vec3 lo, Vec3 hi, std::array<bool, 6> sides, bool faces_inwards) {
    Mesh mesh;
    for (int side = 0; side < 6; ++side) {
        if (!sides[static_cast<std::size_t>(side)]) continue;
        const int axis = side / 2;
        const auto base = static_cast<uint32_t>(mesh.positions.size());
        for (int corner = 0; corner < 4; ++corner) {
            float p[3];
            const int bits[3] = {corner == 1 || corner == 2, corner >= 2, side % 2};
            for (int k = 0; k < 3; ++k) {
                const int at = (axis + 1 + k) % 3;
                p[at] = bits[k] ? component(hi, at) : component(lo, at);
            }
            mesh.positions.push_back({p[0], p[1], p[2]});
        }
        const bool flip = (side % 2 == 0) != faces_inwards;
        for (const uint32_t i : {0u, 1u, 2u, 0u, 2u, 3u}) mesh.indices.push_back(base + i);
        if (flip) {
            for (std::size_t i = mesh.indices.size() - 6; i < mesh.indices.size(); i += 3) {
                std::swap(mesh.indices[i + 1], mesh.indices[i + 2]);
            }
        }
    }
    const auto index = static_cast<uint32_t>(scene.meshes.size());
    scene.meshes.push_back(std::move(mesh));
    if (scene.materials.empty()) scene.materials.emplace_back();
    scene.instances.push_back({.name = "box", .mesh = index, .material = 0, .world_from_local = {}});
}

constexpr std::array<bool, 6> kAll = {true, true, true, true, true, true};
constexpr std::array<bool, 6> kWithoutTop = {true, true, true, false, true, true};
constexpr std::array<bool, 6> kWithoutFront = {true, true, true, true, true, false};

Vec3 eye_of(const Camera& camera) { return camera.world_from_camera.translation; }
Vec3 forward_of(const Camera& camera) { return -column(camera.world_from_camera, 2); }

bool is_within(const Bounds3& box, Vec3 p) {
    return p.x > box.lo.x && p.y > box.lo.y && p.z > box.lo.z && p.x < box.hi.x && p.y < box.hi.y && p.z < box.hi.z;
}

/// Tests that every corner of the scene's box is in the picture.
void check_shows_all(const Scene& scene, const Camera& camera, float aspect) {
    const Bounds3 box = bounds_of(scene);
    const Transform view = inverse(camera.world_from_camera);
    const float half = std::tan(0.5f * camera.fov_y);
    for (int corner = 0; corner < 8; ++corner) {
        const Vec3 p = transform_point(view, {corner & 1 ? box.hi.x : box.lo.x, corner & 2 ? box.hi.y : box.lo.y,
                                              corner & 4 ? box.hi.z : box.lo.z});
        CHECK(p.z < 0);
        CHECK(pertev::abs(p.y) <= -p.z * half);
        CHECK(pertev::abs(p.x) <= -p.z * half * aspect);
    }
}

} // namespace

TEST_CASE("rays find the nearest triangle and its side, even through a mirrored instance") {
    Scene scene;
    add_box(scene, {-1, -1, -1}, {1, 1, 1}, kAll, false);
    const SurveyRay ray = {{-5, 0.2f, 0.3f}, {1, 0, 0}};
    SurveyHit hit = cast_rays(scene, {&ray, 1})[0];
    CHECK(hit.distance == doctest::Approx(4));
    CHECK(hit.is_front);
    scene.instances[0].world_from_local = compose(make_translation({2, 0, 0}), make_scale({-1, 2, 1}));
    hit = cast_rays(scene, {&ray, 1})[0];
    CHECK(hit.distance == doctest::Approx(6));
    CHECK(hit.is_front);
    const SurveyRay inside = {{2, 0, 0}, {0, 1, 0}};
    hit = cast_rays(scene, {&inside, 1})[0];
    CHECK(hit.distance == doctest::Approx(2));
    CHECK(!hit.is_front);
    const SurveyRay away = {{-5, 0, 0}, {-1, 0, 0}};
    CHECK(!cast_rays(scene, {&away, 1})[0].is_hit());
}

TEST_CASE("rays find the same hits in any order of triangles, which decides those that they skip together") {
    test::Random random(9);
    Scene scene;
    Mesh sorted;
    for (uint32_t i = 0; i < 600; ++i) { // small neighbours along a spiral
        const float turn = 0.05f * static_cast<float>(i);
        const Vec3 at = {cos(turn), 0.004f * static_cast<float>(i) - 1.2f, sin(turn)};
        for (int k = 0; k < 3; ++k) {
            sorted.indices.push_back(static_cast<uint32_t>(sorted.positions.size()));
            sorted.positions.push_back(at + random.point(-0.15f, 0.15f));
        }
    }
    std::vector<SurveyRay> rays;
    for (int i = 0; i < 200; ++i) {
        const Vec3 origin = 3.0f * random.direction();
        const bool is_along = i % 4 == 0; // parallel to two axes
        rays.push_back(
            {origin, is_along ? Vec3{0, 0, origin.z < 0 ? 1.0f : -1.0f} : normalize(random.point(-1, 1) - origin)});
    }
    scene.meshes.push_back(sorted);
    scene.materials.emplace_back();
    scene.instances.push_back({.name = "spiral", .mesh = 0, .material = 0, .world_from_local = {}});
    const std::vector<SurveyHit> expected = cast_rays(scene, rays);
    CHECK(std::ranges::count_if(expected, &SurveyHit::is_hit) > 60);
    CHECK(std::ranges::count_if(expected, &SurveyHit::is_hit) < 190);
    for (std::size_t i = 600; i-- > 1;) { // shuffles
        const std::size_t other = random.below(static_cast<uint32_t>(i) + 1);
        for (std::size_t k = 0; k < 3; ++k) std::swap(sorted.indices[3 * i + k], sorted.indices[3 * other + k]);
    }
    scene.meshes[0] = sorted;
    const std::vector<SurveyHit> shuffled = cast_rays(scene, rays);
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const SurveyHit alone = cast_rays(scene, {&rays[i], 1})[0];
        CHECK(shuffled[i].distance == expected[i].distance);
        CHECK(shuffled[i].is_front == expected[i].is_front);
        CHECK(alone.distance == expected[i].distance);
    }
}

TEST_CASE("rays see the front of a sheet with two coincident sides, whichever triangle is first") {
    for (const bool is_front_first : {true, false}) {
        for (const std::size_t between : {std::size_t{0}, std::size_t{20'000}}) { // the second runs on another thread
            Scene scene;
            Mesh mesh;
            mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}, {50, 50, 50}, {51, 50, 50}, {50, 51, 50}};
            const std::array<uint32_t, 3> front = {0, 1, 2}, back = {0, 2, 1};
            const auto add = [&](const std::array<uint32_t, 3>& triangle) {
                mesh.indices.insert(mesh.indices.end(), triangle.begin(), triangle.end());
            };
            add(is_front_first ? front : back);
            for (std::size_t i = 0; i < between; ++i) add({3, 4, 5});
            add(is_front_first ? back : front);
            scene.meshes.push_back(std::move(mesh));
            scene.materials.emplace_back();
            scene.instances.push_back({.name = "sheet", .mesh = 0, .material = 0, .world_from_local = {}});
            const SurveyRay ray = {{0, 0, 5}, {0, 0, -1}};
            const SurveyHit hit = cast_rays(scene, {&ray, 1})[0];
            CHECK(hit.distance == 5);
            CHECK(hit.is_front);
        }
    }
}

TEST_CASE("the view shows a whole solid object from outside and above, at any aspect") {
    for (const Vec3 size : {Vec3{1, 1, 1}, Vec3{10, 0.1f, 3}, Vec3{1e-3f, 2e-3f, 1e-3f}, Vec3{1, 100, 1}}) {
        for (const float aspect : {16.0f / 9.0f, 1.0f, 0.5f}) {
            Scene scene;
            add_box(scene, {}, size, kAll, false);
            Messages messages;
            const Camera camera = make_default_camera(scene, aspect, messages);
            check_shows_all(scene, camera, aspect);
            CHECK(forward_of(camera).y < 0);
            REQUIRE(messages.all().size() == 1);
            CHECK(messages.all()[0].text.find("outside") != std::string::npos);
        }
    }
}

TEST_CASE("the view shows the front of a square with a hidden back, wherever that points") {
    for (const Vec3 front :
         {Vec3{0, 0, 1}, Vec3{0, 0, -1}, Vec3{1, 0, 0}, Vec3{-1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, -1, 0}}) {
        CAPTURE(front.x);
        CAPTURE(front.y);
        CAPTURE(front.z);
        Scene scene;
        const Vec3 u = {front.y, front.z, front.x}, v = cross(front, u);
        Mesh mesh;
        mesh.positions = {-u - v, u - v, u + v, v - u};
        mesh.indices = {0, 1, 2, 0, 2, 3};
        scene.meshes.push_back(std::move(mesh));
        scene.materials.emplace_back().double_sided = false;
        scene.instances.push_back({.name = "square", .mesh = 0, .material = 0, .world_from_local = {}});
        Messages messages;
        const Camera camera = make_default_camera(scene, 1, messages);
        check_shows_all(scene, camera, 1);
        CHECK(dot(normalize(eye_of(camera)), front) > 0.25f); // not at a grazing angle
        const SurveyRay ray = {eye_of(camera), forward_of(camera)};
        CHECK(cast_rays(scene, {&ray, 1}, Backs::Shown)[0].is_hit());
        scene.materials[0].double_sided = true; // the front of glTF models is preferred
        CHECK(forward_of(make_default_camera(scene, 1, messages)).z < -0.6f);
    }
}

TEST_CASE("glass walls and hollow objects that are closed outside are not rooms") {
    Scene vase; // the outer and inner surface of a hollow block
    add_box(vase, {-1, 0, -1}, {1, 3, 1}, kAll, false);
    add_box(vase, {-0.9f, 0.1f, -0.9f}, {0.9f, 2.9f, 0.9f}, kAll, true);
    vase.materials[0].kind = MaterialKind::Dielectric;
    CHECK(survey_surroundings(vase).kind == SurroundingsKind::Object);
    Scene shoe; // long, and open at the top
    add_box(shoe, {-2, 0, -0.6f}, {2, 1, 0.6f}, kWithoutTop, false);
    add_box(shoe, {-1.9f, 0.1f, -0.5f}, {1.9f, 1, 0.5f}, kWithoutTop, true);
    CHECK(survey_surroundings(shoe).kind == SurroundingsKind::Object);
    Messages messages;
    CHECK(!is_within(bounds_of(shoe), eye_of(make_default_camera(shoe, 1.5f, messages))));
}

TEST_CASE("the view of a closed room or a long court open at the top is inside, along its length") {
    for (const auto& sides : {kAll, kWithoutTop}) {
        for (const bool along_x : {true, false}) {
            Scene scene;
            add_box(scene, {0, 0, 0}, along_x ? Vec3{20, 6, 8} : Vec3{8, 6, 20}, sides, true);
            Messages messages;
            const Camera camera = make_default_camera(scene, 1.5f, messages);
            CHECK(is_within(bounds_of(scene), eye_of(camera)));
            CHECK(eye_of(camera).y == doctest::Approx(1.7));
            CHECK(pertev::abs(along_x ? forward_of(camera).x : forward_of(camera).z) > 0.95f);
            CHECK(messages.all()[0].text.find("inside") != std::string::npos);
        }
    }
}

TEST_CASE("a panel of two sheets that face each other is not a room") {
    Scene scene;
    add_box(scene, {-1, -1, 0}, {1, 1, 0.07f}, kAll, true);
    Messages messages;
    const Camera camera = make_default_camera(scene, 1.5f, messages);
    CHECK(!is_within(bounds_of(scene), eye_of(camera)));
    check_shows_all(scene, camera, 1.5f);
}

TEST_CASE("the view of a box with an open front is through its open side") {
    Scene scene;
    add_box(scene, {-1, 0, -1}, {1, 2, 1}, kWithoutFront, true);
    Messages messages;
    const Camera camera = make_default_camera(scene, 1, messages);
    CHECK(forward_of(camera).z == doctest::Approx(-1));
    CHECK(eye_of(camera).z > 1);
    check_shows_all(scene, camera, 1);
}

TEST_CASE("a scene without light gets a sky with a notice, and a scene with light does not") {
    Scene scene;
    add_box(scene, {}, {1, 1, 1}, kAll, false);
    Messages messages;
    CHECK(add_default_light(scene, SceneUse::Picture, messages) == DefaultLight::Sky);
    REQUIRE(scene.environment);
    const Image& sky = scene.environment->image;
    CHECK(sky.width == 2 * sky.height);
    float least = kInfinity, most = 0;
    for (const float value : sky.pixels) {
        least = min(least, value);
        most = max(most, value);
    }
    CHECK(least > 0.1f);
    CHECK(most < 100);
    CHECK(most > 7);
    CHECK(luminance(Rgb{sky.at(9, 9)[0], sky.at(9, 9)[1], sky.at(9, 9)[2]}) > luminance(Rgb{sky.at(9, 120)[0], 0, 0}));
    CHECK(messages.all().size() == 1);

    for (int kind = 0; kind < 3; ++kind) {
        Scene lit;
        add_box(lit, {}, {1, 1, 1}, kAll, false);
        if (kind == 0) lit.lights.emplace_back();
        if (kind == 1) lit.materials[0].emission = grey(1);
        if (kind == 2) lit.environment.emplace().scale = grey(0);
        const std::size_t lights = lit.lights.size();
        Messages silent;
        add_default_light(lit, SceneUse::Measurement, silent);
        CHECK(silent.all().empty());
        CHECK(lit.lights.size() == lights);
    }
}

TEST_CASE("unlit materials and lights of intensity 0 give no light, and a completely unlit scene needs none") {
    const auto gets_sky = [](const auto& change) {
        Scene scene;
        add_box(scene, {}, {1, 1, 1}, kAll, false);
        add_box(scene, {2, 0, 0}, {3, 1, 1}, kAll, false);
        scene.instances[1].material = 1;
        scene.materials.emplace_back().kind = MaterialKind::Unlit;
        change(scene);
        Messages messages;
        add_default_light(scene, SceneUse::Picture, messages);
        CHECK(messages.all().size() == (scene.environment ? 1 : 0)); // the notice comes from the caller
        return scene.environment.has_value();
    };
    CHECK(gets_sky([](Scene&) {}));
    CHECK(gets_sky([](Scene& scene) { scene.materials[1].emission = grey(1); })); // an unlit material does not emit
    CHECK(gets_sky([](Scene& scene) { scene.lights.emplace_back().intensity = grey(0); }));
    CHECK(!gets_sky([](Scene& scene) { scene.instances[0].material = 1; }));
    CHECK(!gets_sky([](Scene& scene) { scene.lights.emplace_back().intensity = {0, 0, 0.1f}; }));
}

TEST_CASE("a closed room without light gets emitters inside it") {
    Scene scene;
    add_box(scene, {0, 0, 0}, {20, 6, 8}, kAll, true);
    Messages messages;
    add_default_light(scene, SceneUse::Picture, messages);
    CHECK(!scene.environment);
    REQUIRE(!scene.lights.empty());
    for (const Light& light : scene.lights) CHECK(is_within(bounds_of(scene), light.position));
}

TEST_CASE("the view is inside Sibenik and Sponza, in front of McGuire's Cornell box, and outside the bunny") {
    struct Expected {
        const char* path;
        SurroundingsKind kind;
    };
    for (const Expected& expected : {Expected{"sibenik/sibenik.obj", SurroundingsKind::Room},
                                     Expected{"crytek-sponza/sponza.obj", SurroundingsKind::Room},
                                     Expected{"cornell-box-mcguire/CornellBox-Sphere.obj", SurroundingsKind::Stage},
                                     Expected{"stanford/bunny.ply", SurroundingsKind::Object}}) {
        const auto path = test::test_scene(expected.path);
        if (!path) continue;
        CAPTURE(expected.path);
        Messages messages;
        const Scene scene = read_scene(*path, {.allowed_paths = {}, .geometry_only = true}, messages);
        CHECK(survey_surroundings(scene).kind == expected.kind);
    }
}
