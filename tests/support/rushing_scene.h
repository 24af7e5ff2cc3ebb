#pragma once

// A scene in which instances move while the shutter is open, and a camera that moves.

#include "scene/validate/validate.h"
#include "session/shutter.h"
#include "tests/support/render_scenes.h"

namespace pertev::test {

inline constexpr Shutter kHalfASecond = {-0.1, 0.4};

/// The mixed scene, in which two spheres of one mesh, an emitter and a sheet move and turn if `moves`.
inline Scene make_rushing_scene(bool moves = true) {
    Scene scene = make_mixed_scene();
    Messages messages;
    validate(scene, "mixed", messages);
    scene.nodes.resize(4);
    const uint32_t instances[] = {1, 2, 5, 7};
    scene.animations.emplace_back();
    for (uint32_t node = 0; node < 4; ++node) {
        Instance& instance = scene.instances[instances[node]];
        instance.node = node;
        instance.node_from_local = instance.world_from_local;
        const float way = moves ? 1.0f : 0.0f, turn = moves ? 0.38268343f : 0.0f;
        const auto n = static_cast<float>(node);
        scene.animations[0].channels.push_back({node,
                                                AnimatedPart::Translation,
                                                Interpolation::Linear,
                                                {0, 1},
                                                {0, 0, 0, way * (0.8f - 0.4f * n), 0.3f * way, 0.2f * way}});
        scene.animations[0].channels.push_back({node,
                                                AnimatedPart::Rotation,
                                                Interpolation::Linear,
                                                {0, 1},
                                                {0, 0, 0, 1, 0, turn, 0, moves ? 0.92387953f : 1.0f}});
    }
    validate(scene, "rushing", messages);
    return scene;
}

/// The camera of the mixed scene, which moves to the right and turns.
inline Camera rushing_camera() {
    Camera camera = mixed_scene_camera();
    const Vec3 eye = camera.world_from_camera.translation;
    camera.aperture_radius = 0.05f;
    camera.focus_distance = 6;
    camera.motion = {{{0, 0, 0, 1}, eye}, {{0, 0.02f, 0, 0.9998f}, eye + Vec3{0.3f, 0, 0}}};
    return camera;
}

} // namespace pertev::test
