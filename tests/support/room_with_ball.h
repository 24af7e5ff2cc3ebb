#pragma once

// A room that is open to the camera and contains a ball. Integrators are compared with path tracing there.

#include "tests/support/flat_scenes.h"
#include "tests/support/meshes.h"
#include "tests/support/render_scenes.h"

namespace pertev::test {

/// A room with an emitter under the ceiling or, without one, with the sky of the mixed scene.
inline Scene room_with_ball(const Material& ball_material, const Material& floor, bool has_sky) {
    Scene scene;
    const Material red = {{.base_color = {0.7f, 0.2f, 0.2f}}, "red"};
    add(scene, sheet({0, 0, 0}, {0, 0, 1}, {1, 0, 0}), floor);
    add(scene, sheet({0, 1, -1}, {1, 0, 0}, {0, 1, 0}), white(0.6f));
    add(scene, sheet({-1, 1, 0}, {0, 1, 0}, {0, 0, 1}), red);
    const TriangleMesh ball = make_sphere(2, {0.1f, 0.6f, 0.1f}, 0.4f);
    Mesh mesh;
    mesh.positions = ball.positions;
    mesh.indices = ball.indices;
    add(scene, mesh, ball_material);
    if (has_sky) {
        scene.environment = make_mixed_scene().environment;
        return scene;
    }
    add(scene, sheet({0, 2, 0}, {1, 0, 0}, {0, 0, 1}), white(0.6f));
    add(scene, sheet({-0.1f, 1.9f, 0}, {0.5f, 0, 0}, {0, 0, 0.5f}),
        {{.base_color = {0.2f, 0.2f, 0.2f}, .emission = {4, 3.5f, 3}}, "lamp"});
    return scene;
}

/// A camera that shows the whole room.
inline Camera room_camera() {
    Camera camera;
    camera.world_from_camera = look_at({0.4f, 1.1f, 3.6f}, {0, 0.9f, 0}, {0, 1, 0});
    camera.fov_y = 0.6f;
    return camera;
}

inline Material of_roughness(MaterialKind kind, float roughness, float metallic = 0) {
    return {{.kind = kind, .base_color = {0.9f, 0.8f, 0.7f}, .metallic = metallic, .roughness = roughness}, "ball"};
}

} // namespace pertev::test
