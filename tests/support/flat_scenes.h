#pragma once

// Scenes of a few flat sheets whose pictures have closed forms, and an orthographic camera above them.

#include "scene/scene.h"

namespace pertev::test {

/// The sheet centre + s x + t y for s, t in [-1, 1], with its front in the direction of cross(x, y).
inline Mesh sheet(Vec3 centre, Vec3 x, Vec3 y) {
    Mesh mesh;
    mesh.positions = {centre - x - y, centre + x - y, centre + x + y, centre - x + y};
    mesh.indices = {0, 1, 2, 0, 2, 3};
    return mesh;
}

inline void add(Scene& scene, Mesh mesh, const Material& material) {
    scene.meshes.push_back(std::move(mesh));
    scene.materials.push_back(material);
    scene.instances.push_back(
        {"", static_cast<uint32_t>(scene.meshes.size() - 1), static_cast<uint32_t>(scene.materials.size() - 1), {}});
}

/// A sheet of side 2 `half` in the plane y = `height` about (0, height, 0) that faces up.
inline Mesh floor_at(float height, float half) { return sheet({0, height, 0}, {0, 0, half}, {half, 0, 0}); }

inline Material white(float albedo = 1) { return {{.base_color = grey(albedo)}, "white"}; }
/// A perfect mirror.
inline Material mirror() {
    return {{.kind = MaterialKind::MetallicRoughness, .base_color = {1, 1, 1}, .metallic = 1, .roughness = 0},
            "mirror"};
}

inline Light point_light(Vec3 position, Rgb intensity) {
    Light light;
    light.kind = LightKind::Point;
    light.position = position;
    light.intensity = intensity;
    return light;
}

/// A floor under a spot light that is one metre above it and points straight down.
inline Scene floor_under_spot() {
    Scene scene;
    add(scene, floor_at(0, 4), white(0.5f));
    Light spot = point_light({0, 1, 0}, {8, 8, 8});
    spot.kind = LightKind::Spot;
    spot.direction = {0, -1, 0};
    spot.cos_inner = 0.971f;
    spot.cos_outer = 0.97f;
    scene.lights.push_back(spot);
    return scene;
}

/// An orthographic camera that looks straight down from `eye`; the picture's right is +x, its lower edge +z.
inline Camera camera_down(Vec3 eye, float height) {
    Camera camera;
    camera.projection = Projection::Orthographic;
    camera.ortho_height = height;
    camera.world_from_camera = look_at(eye, eye + Vec3{0, -1, 0}, {0, 0, -1});
    return camera;
}

} // namespace pertev::test
