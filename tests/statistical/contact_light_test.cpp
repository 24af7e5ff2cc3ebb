// A slab crosses a lit floor just above it: neither the light of before nor that beside may be shown in the gap.

#include <doctest/doctest.h>

#include "render/update_scene.h"
#include "session/session.h"
#include "tests/support/lit_scenes.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"

using namespace pertev;
using namespace pertev::test;

namespace {

constexpr uint32_t kGapWidth = 128, kGapHeight = 48, kFirstInGap = 12, kFramesOfGap = 30;
constexpr float kStepOverGap = 0.05f; // metres, five pixels
constexpr float kGap = 0.02f;         // metres, two pixels

/// A floor, a slab above it (instance 1) and a small emitter.
Scene scene_of_gap() {
    Scene scene;
    const Mesh square = make_square(1);
    Material grey;
    grey.base_color = {0.5f, 0.5f, 0.5f};
    grey.double_sided = true;
    scene.materials.push_back(grey);
    scene.meshes = {square};
    Instance floor, slab;
    floor.mesh = slab.mesh = 0, floor.material = slab.material = 0;
    floor.world_from_local = make_scale({20, 1, 20});
    slab.world_from_local = compose(make_translation({-1, kGap, 0}), make_scale({0.2f, 1, 0.2f}));
    scene.instances = {floor, slab};
    add_emitter(scene, square, {400, 400, 400}, compose(make_translation({0, 4, 0}), make_scale({0.1f, 1, 0.1f})));
    return scene;
}

Camera camera_of_gap() {
    Camera camera;
    camera.world_from_camera = look_at({0, 0.5f, 3}, {0, 0, 0}, {0, 1, 0});
    camera.fov_y = 0.16f;
    return camera;
}

struct LightOfGap {
    double gap = 0, beside = 0; // mean over that of references where it is lit
};

/// Returns the light of frames in the gap, which is dark, and in the rows before it.
LightOfGap light_of_gap(bool follows) {
    Messages messages;
    Scene scene = scene_of_gap();
    PreparedScene prepared = prepare_scene(scene, {}, messages);
    RenderSettings settings;
    settings.width = kGapWidth, settings.height = kGapHeight;
    settings.path.max_depth = 1;
    Queue queue = requested_queue();
    Session frames(queue, prepared, camera_of_gap(), settings), references(queue, prepared, camera_of_gap(), settings);
    LightOfGap light;
    double pixels = 0, pixels_beside = 0;
    for (uint32_t k = 0; k < kFramesOfGap; ++k) {
        scene.instances[1].world_from_local.translation.x += kStepOverGap;
        SceneUpdate update;
        update.moved_instances = {1};
        prepared = update_scene(prepared, scene, update, messages);
        frames.update_scene(prepared, parts_of(update));
        frames.render_frame(k, {.temporal_gradients = follows});
        if (k < kFirstInGap) continue;
        references.update_scene(prepared, parts_of(update));
        references.cut();
        references.render(16);
        const Image now = references.picture(), shown = frames.frame().picture();
        const auto lit = static_cast<double>(now.at(2, kGapHeight - 2)[1]);
        for (uint32_t y = 0; y + 3 < kGapHeight; ++y) {
            for (uint32_t x = 0; x < kGapWidth; ++x) {
                const auto value = static_cast<double>(now.at(x, y)[1]) / lit,
                           share = static_cast<double>(shown.at(x, y)[1]) / lit;
                if (value < 0.05) light.gap += share, ++pixels;
                const bool is_dark_above = static_cast<double>(now.at(x, y > 2 ? y - 3 : 0)[1]) < 0.05 * lit;
                if (is_dark_above && value > 0.9) light.beside += share / value, ++pixels_beside;
            }
        }
    }
    REQUIRE(pixels > 30 * (kFramesOfGap - kFirstInGap));
    REQUIRE(pixels_beside > 30 * (kFramesOfGap - kFirstInGap));
    return {light.gap / pixels, light.beside / pixels_beside};
}

} // namespace

TEST_CASE("a gap under a moving object is as dark as it is, and the floor before it as bright") {
    const LightOfGap light = light_of_gap(true), late = light_of_gap(false);
    MESSAGE("in the gap ", light.gap, " of the light beside, without temporal gradients ", late.gap, "; before it ",
            light.beside, ", ", late.beside);
    CHECK(light.gap < 0.2);
    CHECK(late.gap > 0.8); // history and neighbours are bright enough to matter
    CHECK(light.beside == doctest::Approx(1).epsilon(0.02));
}
