#pragma once

// How many of a picture's rays from the camera pass the back of a surface that hides it: of a fixed grid of rays, each
// traced with and without. A function of scene, camera and the picture's shape; the same on every device.

#include "device/atomic_add.h"
#include "math/random.h"
#include "render/accept_hit.h"
#include "render/camera_view.h"
#include "trace/trace_closest.h"

namespace pertev {

struct CountHiddenBacks {
    static constexpr uint32_t kSide = 64, kRays = kSide * kSide; // spread over the picture, whatever its size

    SceneView scene;
    CameraView camera;
    float width, height; // pixels
    uint32_t* count;

    HD void operator()(uint32_t i) const {
        const Vec2 place = {(static_cast<float>(i % kSide) + 0.5f) * (width / kSide),
                            (static_cast<float>(i / kSide) + 0.5f) * (height / kSide)};
        const Ray ray = make_camera_ray(camera, place, {0.5f, 0.5f}); // through the middle of the lens
        const AcceptHit accept{scene, {}, {}, hash_words(i, 0, 0, 0).x};
        Hit met, seen; // with the hidden backs and without
        trace_closest(scene.bvh, ray, accept, met);
        trace_closest(scene.bvh, ray, AcceptCameraHit{accept, ray.direction}, seen);
        const bool passed = met.instance != seen.instance || met.primitive != seen.primitive;
        if (passed) atomic_add(count, 1u);
    }
};

} // namespace pertev
