// A square slides into the light of an emitter within its own plane: each pixel in which it stays sees the same place
// in the same light, but a point of the square is lit more from frame to frame, and so must its mean be.

#include <doctest/doctest.h>

#include "render/update_scene.h"
#include "session/session.h"
#include "tests/support/lit_scenes.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"

using namespace pertev;
using namespace pertev::test;

namespace {

constexpr uint32_t kFaceWidth = 96, kFaceHeight = 32, kFirstFace = 16, kFramesOfFace = 32;
constexpr float kStepOfFace = 0.04f; // metres, about two pixels

/// The square (instance 0) and a small emitter before the right end of its way.
Scene scene_of_face() {
    Scene scene;
    const Mesh square = make_square(1);
    Material grey;
    grey.base_color = {0.5f, 0.5f, 0.5f};
    grey.double_sided = true;
    scene.materials.push_back(grey);
    scene.meshes = {square};
    Instance face;
    face.mesh = 0, face.material = 0;
    face.world_from_local = compose(make_translation({-1, 0, 0}), compose(make_rotation(0.70710678f, 0, 0, 0.70710678f),
                                                                          make_scale({0.25f, 1, 0.25f})));
    scene.instances = {face};
    add_emitter(scene, square, {200, 200, 200},
                compose(make_translation({1.2f, 1.2f, 0.6f}), make_scale({0.1f, 1, 0.1f})));
    return scene;
}

/// Returns the light of the square in frames over that of references.
double light_of_face(Queue& queue, bool follows, Projection projection) {
    Messages messages;
    Scene scene = scene_of_face();
    PreparedScene prepared = prepare_scene(scene, {}, messages);
    RenderSettings settings;
    settings.width = kFaceWidth, settings.height = kFaceHeight;
    settings.path.max_depth = 1;
    Camera camera;
    camera.world_from_camera = look_at({0, 0, 4}, {0, 0, 0}, {0, 1, 0});
    camera.projection = projection;
    camera.fov_y = 0.18f;
    camera.ortho_height = 0.72f;
    Session frames(queue, prepared, camera, settings), references(queue, prepared, camera, settings);
    double light = 0, right = 0;
    for (uint32_t k = 0; k < kFramesOfFace; ++k) {
        scene.instances[0].world_from_local.translation.x += kStepOfFace;
        SceneUpdate update;
        update.moved_instances = {0};
        prepared = update_scene(prepared, scene, update, messages);
        frames.update_scene(prepared, parts_of(update));
        frames.render_frame(k, {.temporal_gradients = follows});
        if (k < kFirstFace) continue;
        references.update_scene(prepared, parts_of(update));
        references.cut();
        references.render(8);
        light += test::mean_of(frames.frame().picture()), right += test::mean_of(references.picture());
    }
    return light / right;
}

} // namespace

TEST_CASE("a face that moves into light is as bright as it is") {
    Queue queue = requested_queue();
    for (const Projection projection : {Projection::Perspective, Projection::Orthographic}) {
        const double followed = light_of_face(queue, true, projection), late = light_of_face(queue, false, projection);
        MESSAGE(followed, " of the light, without temporal gradients ", late);
        CHECK(followed == doctest::Approx(1).epsilon(0.03));
        CHECK(late < 0.85); // the change is large enough to be detected
    }
}
