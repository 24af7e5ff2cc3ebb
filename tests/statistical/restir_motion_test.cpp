// A box crosses a lit floor: where its shadow has just been, reservoirs that found no light must not count as ones that
// could have found it.

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "render/update_scene.h"
#include "session/session.h"
#include "tests/support/lit_scenes.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"

using namespace pertev;
using namespace pertev::test;

namespace {

constexpr uint32_t kCrossingWidth = 128, kCrossingHeight = 64, kFirstCrossing = 12, kTrail = 3;
/// The number of frames whose trail is measured.
uint32_t crossing_frames() { return static_cast<uint32_t>(effort(16, 32)); }
constexpr float kStepOfFrame = 0.125f; // metres, five pixels

/// A floor, a box on it (instance 1) and a small emitter above, which throws the box's shadow to the side.
Scene scene_of_crossing() {
    Scene scene;
    const Mesh square = make_square(1);
    Material grey;
    grey.base_color = {0.5f, 0.5f, 0.5f};
    grey.double_sided = true;
    scene.materials.push_back(grey);
    Mesh box;
    for (const Transform& side :
         {make_translation({0, 1, 0}), make_rotation(1, 0, 0, 0),
          compose(make_rotation(0.70710678f, 0, 0, 0.70710678f), make_translation({0, 1, 0})),
          compose(make_rotation(0.70710678f, 0, 0, -0.70710678f), make_translation({0, 1, 0})),
          compose(make_rotation(0, 0, 0.70710678f, 0.70710678f), make_translation({0, 1, 0})),
          compose(make_rotation(0, 0, 0.70710678f, -0.70710678f), make_translation({0, 1, 0}))}) {
        const auto base = static_cast<uint32_t>(box.positions.size());
        for (const Vec3 p : square.positions) box.positions.push_back(transform_point(side, p));
        for (const uint32_t i : square.indices) box.indices.push_back(base + i);
    }
    scene.meshes = {square, box};
    Instance floor, block;
    floor.mesh = 0, floor.material = 0;
    floor.world_from_local = make_scale({20, 1, 20});
    block.mesh = 1, block.material = 0;
    block.world_from_local = compose(make_translation({-2.2f, 0.3f, 0}), make_scale({0.25f, 0.25f, 0.25f}));
    scene.instances = {floor, block};
    add_emitter(scene, square, {400, 400, 400}, compose(make_translation({0, 4, -3}), make_scale({0.1f, 1, 0.1f})));
    return scene;
}

Camera camera_of_crossing() {
    Camera camera;
    camera.world_from_camera = look_at({0, 4, 3}, {0, 0, 0.3f}, {0, 1, 0});
    camera.fov_y = 0.3f;
    return camera;
}

void move_block(Scene& scene, PreparedScene& prepared, Session& session) {
    Messages messages;
    scene.instances[1].world_from_local.translation.x += kStepOfFrame;
    SceneUpdate update;
    update.moved_instances = {1};
    prepared = update_scene(prepared, scene, update, messages);
    session.update_scene(prepared, parts_of(update));
}

RenderSettings settings_of_crossing(uint32_t max_depth) {
    RenderSettings settings;
    settings.width = kCrossingWidth, settings.height = kCrossingHeight;
    settings.path.max_depth = max_depth;
    return settings;
}

/// Path-traced pictures of the frames from kFirstCrossing - kTrail on.
std::vector<Image> references_of_crossing(uint32_t max_depth) {
    Messages messages;
    Scene scene = scene_of_crossing();
    PreparedScene prepared = prepare_scene(scene, {}, messages);
    Queue queue = requested_queue();
    Session session(queue, prepared, camera_of_crossing(), settings_of_crossing(max_depth));
    std::vector<Image> pictures;
    for (uint32_t k = 0; k < kFirstCrossing + crossing_frames(); ++k) {
        move_block(scene, prepared, session);
        if (k + kTrail < kFirstCrossing) continue;
        session.cut();
        session.render(static_cast<uint32_t>(effort(4, 16)));
        pictures.push_back(session.picture());
    }
    return pictures;
}

/// Returns the light of frames over that of references, on the floor where the shadow was up to kTrail frames before.
double light_in_trail(const std::vector<Image>& references, const RestirSettings& restir, bool follows = true) {
    ReconstructionSettings raw = of_samples_alone({});
    raw.temporal_gradients = follows;
    Messages messages;
    Scene scene = scene_of_crossing();
    PreparedScene prepared = prepare_scene(scene, {}, messages);
    Queue queue = requested_queue();
    Session frames(queue, prepared, camera_of_crossing(),
                   settings_of_crossing(restir.light == RestirLight::Indirect ? 2 : 1));
    double light = 0, right = 0, pixels = 0;
    for (uint32_t k = 0; k < kFirstCrossing + crossing_frames(); ++k) {
        move_block(scene, prepared, frames);
        frames.render_frame(k, raw, restir);
        if (k < kFirstCrossing) continue;
        const std::size_t at = k - kFirstCrossing + kTrail;
        const Image &now = references[at], shown = frames.frame().picture();
        const double lit = 0.9 * static_cast<double>(now.at(2, kCrossingHeight / 2)[1]);
        for (uint32_t y = 0; y < kCrossingHeight; ++y) {
            for (uint32_t x = 0; x < kCrossingWidth; ++x) {
                bool was_dark = false;
                for (uint32_t j = 2; j <= kTrail + 1; ++j) {
                    was_dark = was_dark || static_cast<double>(references[at + 1 - j].at(x, y)[1]) < 0.02 * lit;
                }
                const auto value = static_cast<double>(now.at(x, y)[1]);
                if (!was_dark || value < 0.5 * lit) continue;
                light += static_cast<double>(shown.at(x, y)[1]), right += value, ++pixels;
            }
        }
    }
    REQUIRE(pixels > 20 * crossing_frames());
    return light / right;
}

} // namespace

TEST_CASE("with ReSTIR a moving shadow leaves no trail") {
    const std::vector<Image> direct = references_of_crossing(1);
    const double without = light_in_trail(direct, {.light = RestirLight::Direct, .history = 0});
    CHECK(without == doctest::Approx(1).epsilon(0.05));
    CHECK(light_in_trail(direct, {.light = RestirLight::Direct}, false) < 0.8); // the change of light is unknown
    for (const RestirLight light : {RestirLight::Direct, RestirLight::Indirect}) {
        const double with =
            light_in_trail(light == RestirLight::Direct ? direct : references_of_crossing(2), {.light = light});
        MESSAGE(with, " of the light with history, ", without, " without");
        CHECK(with == doctest::Approx(1).epsilon(0.05));
    }
}
