#pragma once

// A scene of eight balls, each with another lobe.

#include <utility>

#include "tests/support/flat_scenes.h"
#include "tests/support/solid_scenes.h"

namespace pertev::test {

struct LayeredBalls {
    Scene scene;
    Camera camera;
};

inline Material layered(const char* name, MaterialParameters parameters) {
    parameters.kind = MaterialKind::MetallicRoughness;
    return {parameters, name};
}

/// Eight balls before a wall of rough diffuse reflection, lit by an emitter above and a light beside the camera. Each
/// ball has another lobe besides Lambert's and a plain reflection, and covers two blocks of the picture, one above the
/// other.
inline LayeredBalls layered_balls() {
    const Material materials[] = {
        layered("coat", {.base_color = {0.7f, 0.2f, 0.1f},
                         .roughness = 0.6f,
                         .coat_weight = 1,
                         .coat_roughness = 0.1f,
                         .coat_color = {0.9f, 0.7f, 0.5f}}),
        layered("sheen", {.base_color = {0, 0, 0}, .fuzz_weight = 1, .fuzz_roughness = 0.4f}),
        layered("fuzz", {.fuzz_model = FuzzModel::Zeltner,
                         .base_color = {0, 0.1f, 0.3f},
                         .fuzz_weight = 1,
                         .fuzz_roughness = 0.6f}),
        layered("film", {.base_color = {0.1f, 0.1f, 0.1f}, .roughness = 0.3f, .thin_film_weight = 1}),
        layered("leaf", {.base_color = {0, 0, 0},
                         .roughness = 0.5f,
                         .diffuse_transmission_weight = 0.5f,
                         .diffuse_transmission_color = {0.4f, 0.8f, 0.1f}}),
        layered("retro", {.base_color = {0.5f, 0.4f, 0.1f}, .roughness = 0.4f, .specular_retroreflectivity = 0.8f}),
        {{.base_color = {0.8f, 0.6f, 0.4f}, .base_diffuse_roughness = 1}, "clay"},
        layered("frosted", {.base_color = {0.8f, 0.9f, 0.9f}, .roughness = 0.5f, .transmission_weight = 0.9f})};
    LayeredBalls balls;
    for (int i = 0; i < 8; ++i) {
        const Vec3 centre = {static_cast<float>(2 * (i % 4) - 3), i < 4 ? 1.5f : -1.5f, 0};
        Mesh mesh = ball(centre, 0.9f);
        for (const Vec3 p : mesh.positions) mesh.normals.push_back(normalize(p - centre));
        add(balls.scene, std::move(mesh), materials[i]);
    }
    add(balls.scene, sheet({0, 0, -1.5f}, {6, 0, 0}, {0, 5, 0}),
        {{.base_color = {0.5f, 0.6f, 0.7f}, .base_diffuse_roughness = 1}, "wall"});
    add(balls.scene, sheet({1, 5, 3}, {1, 0, 0}, {0, 0.6f, -0.8f}),
        {{.two_sided_emission = true, .base_color = {0, 0, 0}, .emission = {30, 28, 25}}, "lamp"});
    balls.scene.lights.push_back(point_light({0.5f, 0.5f, 8}, {40, 40, 40}));
    balls.camera.projection = Projection::Orthographic;
    balls.camera.ortho_height = 6;
    balls.camera.world_from_camera = look_at({0, 0, 8}, {0, 0, 0}, {0, 1, 0});
    return balls;
}

} // namespace pertev::test
