// Backs of single-sided surfaces: camera rays pass through them, and other rays do not.

#include <algorithm>
#include <cmath>

#include <doctest/doctest.h>

#include "device_scene/accept_hit.h"
#include "device_scene/scene_on_device.h"
#include "session/pictures/render_samples.h"
#include "tests/support/render_scenes.h"

using namespace pertev;

namespace {

/// The unit cube's six faces, which face outwards.
Mesh cube() {
    Mesh mesh;
    for (uint32_t i = 0; i < 8; ++i) {
        mesh.positions.push_back({i & 1 ? 0.5f : -0.5f, i & 2 ? 0.5f : -0.5f, i & 4 ? 0.5f : -0.5f});
    }
    for (const auto& [a, b, c, d] : {std::array{0u, 2u, 3u, 1u},
                                     {4u, 5u, 7u, 6u},
                                     {0u, 1u, 5u, 4u},
                                     {2u, 6u, 7u, 3u},
                                     {0u, 4u, 6u, 2u},
                                     {1u, 3u, 7u, 5u}}) {
        mesh.indices.insert(mesh.indices.end(), {a, b, c, a, c, d});
    }
    return mesh;
}

Mesh turned(Mesh mesh) {
    std::ranges::reverse(mesh.indices);
    return mesh;
}

/// The square [-1, 1]^2 in x and y, which faces +z, `size` times as large.
Mesh sheet(float size = 1) {
    Mesh mesh;
    mesh.positions = {{-size, -size, 0}, {size, -size, 0}, {size, size, 0}, {-size, size, 0}};
    mesh.indices = {0, 1, 2, 0, 2, 3};
    return mesh;
}

uint32_t add_sided(Scene& scene, const Mesh& mesh, bool double_sided, const Transform& place = {}) {
    scene.meshes.push_back(mesh);
    scene.materials.push_back({{.double_sided = double_sided, .base_color = grey(0.5f)}, "grey"});
    const auto last = static_cast<uint32_t>(scene.meshes.size() - 1);
    scene.instances.push_back({"", last, last, place});
    return last;
}

RenderResult render_backs(const Scene& scene, const Camera& camera, PathBody body = PathBody::Loop,
                          uint32_t size = 16) {
    RenderSettings settings;
    settings.width = settings.height = size;
    settings.samples = 4;
    settings.filter = PixelFilter::Box;
    settings.aovs = kAovDepth;
    settings.body = body;
    Queue queue = test::requested_queue();
    return test::render(queue, scene, camera, settings);
}

Camera looking(Vec3 eye, Vec3 target, float height) {
    Camera camera;
    camera.world_from_camera = look_at(eye, target, {0, 1, 0});
    camera.projection = Projection::Orthographic;
    camera.ortho_height = height;
    return camera;
}

float brightest(const Image& image) { return *std::ranges::max_element(image.pixels); }
float darkest(const Image& image) { return *std::ranges::min_element(image.pixels); }

} // namespace

TEST_CASE("only camera rays pass the backs of one-sided surfaces, even mirrored, rotated or tiny") {
    Scene scene;
    const Transform mirror = make_scale({1, 1, -1}); // the sheet's front then faces -z, with the node's +z
    const uint32_t plain = add_sided(scene, sheet(), false), both = add_sided(scene, sheet(), true);
    const uint32_t mirrored = add_sided(scene, sheet(), false, mirror), tiny = add_sided(scene, sheet(1e-25f), false);
    const uint32_t sideways = add_sided(scene, sheet(), false, make_scale({-1, 1, 1})); // mirrored, and still facing +z
    const uint32_t round = add_sided(scene, sheet(), false, make_rotation(0, 1, 0, 0)); // half a turn: it faces -z
    Messages messages;
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    Queue queue = Queue::make_cpu();
    const SceneOnDevice device(queue, prepared);
    const auto meets = [&](uint32_t instance, Vec3 direction, bool from_camera) {
        const AcceptHit accept{device.view(), {}, {}, 1};
        return from_camera ? AcceptCameraHit{accept, direction}(instance, 0, 0.3f, 0.3f)
                           : accept(instance, 0, 0.3f, 0.3f);
    };
    const Vec3 at_front = normalize(Vec3{0.3f, 0.2f, -1}), at_back = normalize(Vec3{0.3f, 0.2f, 1});
    for (const uint32_t instance : {plain, both, mirrored, tiny, sideways, round}) {
        CAPTURE(instance);
        const bool faces_away = instance == mirrored || instance == round;
        CHECK(meets(instance, faces_away ? at_back : at_front, true));
        CHECK(meets(instance, faces_away ? at_front : at_back, true) == (instance == both));
        for (const Vec3 direction : {at_front, at_back}) CHECK(meets(instance, direction, false));
    }
}

TEST_CASE("a closed room stays dark, seen through its walls' backs or from inside") {
    for (const PathBody body : {PathBody::Loop, PathBody::Wavefront}) {
        Scene scene;
        scene.environment = Environment{};
        add_sided(scene, turned(cube()), false); // the faces point inwards, as in a room
        const Camera outside = looking({0, 0, 4}, {0, 0, 0}, 0.5f);
        const RenderResult into = render_backs(scene, outside, body);
        CHECK(brightest(into.picture) == 0);
        CHECK(into.layers[0].image.pixels[0] == doctest::Approx(4.5)); // the far wall
        CHECK(into.hidden_back_share == 1);
        scene.materials[0].double_sided = true;
        const RenderResult at = render_backs(scene, outside, body);
        CHECK(darkest(at.picture) > 0.2f);
        CHECK(at.layers[0].image.pixels[0] == doctest::Approx(3.5));
        CHECK(at.hidden_back_share == 0);

        Scene solid; // the faces point outwards, so the camera and a sheet inside see only backs
        solid.environment = Environment{};
        add_sided(solid, cube(), false);
        add_sided(solid, sheet(0.4f), true);
        const RenderResult inside = render_backs(solid, looking({0, 0, 0.3f}, {0, 0, 0}, 0.5f), body);
        CHECK(brightest(inside.picture) == 0);
        CHECK(inside.layers[0].image.pixels[0] == doctest::Approx(0.3));
        CHECK(inside.hidden_back_share == 0);
        const RenderResult through = render_backs(solid, looking({0, 0, 0.3f}, {0, 0, 1}, 0.5f), body);
        CHECK(darkest(through.picture) == 1); // looks out through a wall at the sky
        CHECK(through.hidden_back_share == 1);
    }
}

TEST_CASE("the share of rays through hidden backs depends on scene and view, not on the picture's size") {
    Scene scene;
    scene.environment = Environment{};
    add_sided(scene, sheet(), false, make_translation({1, 0, 0})); // the right half of the view
    for (const uint32_t size : {1u, 16u, 37u}) {
        CHECK(render_backs(scene, looking({0, 0, -1}, {0, 0, 0}, 2), PathBody::Loop, size).hidden_back_share == 0.5);
        CHECK(render_backs(scene, looking({0, 0, -1}, {0, 0, 0}, 2), PathBody::Wavefront, size).hidden_back_share ==
              0.5);
    }
    CHECK(render_backs(scene, looking({0, 0, 1}, {0, 0, 0}, 2)).hidden_back_share == 0);
    add_sided(scene, sheet(), true, make_translation({1, 0, -0.5f})); // stands before the wall, so no ray passes a back
    CHECK(render_backs(scene, looking({0, 0, -1}, {0, 0, 0}, 2)).hidden_back_share == 0);
}

TEST_CASE("a picture's sink gets a notice of hidden backs, and an error states why a picture has no sample") {
    struct StoppingSink final : Messages {
        bool stops = false;
        bool should_stop() override { return stops; }
    };
    for (const bool double_sided : {false, true}) {
        Scene scene;
        add_sided(scene, sheet(), double_sided);
        Messages messages;
        const PreparedScene prepared = prepare_scene(scene, {}, messages);
        Queue queue = Queue::make_cpu();
        RenderSettings settings;
        settings.width = settings.height = 8, settings.samples = 2;
        Session session(queue, prepared, looking({0, 0, -4}, {0, 0, 0}, 1), settings);
        StoppingSink sink;
        sink.stops = true;
        ErrorCode code = ErrorCode::BadInput;
        try {
            render_samples(session, sink);
        } catch (const Error& error) {
            code = error.code();
            CHECK(error.setting().empty()); // the error is not about `time_limit`
        }
        CHECK(code == ErrorCode::Interrupted);
        CHECK(sink.messages().all().empty());
        sink.stops = false;
        CHECK(render_samples(session, sink).samples == 2);
        CHECK(sink.messages().all().size() == (double_sided ? 0 : 1));
    }
}
