#pragma once

// Motion vectors: how far the content of each pixel has moved in the picture since the previous frame, by the camera,
// its instance and its vertices; for motion blur and temporal filters in other programs. One ray through the pixel's
// centre and the middle of the lens determines the content, because a mean over samples would mix foreground and
// background.

#include "denoise/reproject.h"
#include "image/image.h"
#include "render/picture_view.h"
#include "tracer/scene_tracer.h"

namespace pertev {

/// The stage that makes the ray through the middle of each pixel, and its key for blended surfaces.
struct CentreRays {
    CameraView camera;
    uint32_t width, first; // width in pixels; index of the first pixel
    Ray* rays;
    uint32_t* keys;

    HD void operator()(uint32_t i) const {
        const uint32_t pixel = first + i;
        const Vec2 centre = {static_cast<float>(pixel % width) + 0.5f, static_cast<float>(pixel / width) + 0.5f};
        store_ray(rays + i, make_camera_ray(camera, centre, {0.5f, 0.5f}));
        keys[i] = hash_words(pixel, 0, 0, 0).x;
    }
};

/// The stage that computes the motion of each pixel's hit. A point that was behind the previous camera has no motion;
/// one that did not exist is assumed to have been at its present position.
struct MotionOfHits {
    FrameCameras cameras;
    SceneView scene;
    PreviousScene before;
    HitQueueView hits;
    uint32_t first;
    Vec2* motion; // pixels to the right and up, from the previous position to the present one

    HD void operator()(uint32_t i) const {
        const uint32_t pixel = first + i;
        const Vec2 centre = {static_cast<float>(pixel % cameras.width) + 0.5f,
                             static_cast<float>(pixel / cameras.width) + 0.5f};
        const Hit hit = hits.load(i);
        Vec2 then = centre;
        if (hit.instance == kNoHit) {
            if (faces_sky_before(centre)) then = reproject_far(cameras.now, cameras.before, centre);
        } else {
            const bool was_there = before.instances[hit.instance].is_hidden == 0;
            const Reprojection at =
                reproject_surface(cameras, scene, was_there ? before : PreviousScene{scene.instances, scene.meshes},
                                  centre, {float_of(hit.instance), float_of(hit.primitive), hit.u, hit.v});
            if (is_projected(cameras.before, at.depth)) then = at.pixel;
        }
        const Vec2 moved = {centre.x - then.x, then.y - centre.y};
        motion[i] = is_finite(moved.x) && is_finite(moved.y) ? moved : Vec2{0, 0};
    }

private:
    HD bool faces_sky_before(Vec2 centre) const {
        const Vec3 direction = make_camera_ray(cameras.now, centre, {0.5f, 0.5f}).direction;
        return is_projected(cameras.before, -transform_transposed(cameras.before.world_from_camera, direction).z);
    }
};

/// Memory of motion_vectors while it runs.
struct MotionVectorMemory {
    MotionVectorMemory(Queue& queue, uint32_t width, uint32_t height);

    uint32_t most; // pixels per batch
    Buffer<Ray> rays;
    Buffer<uint32_t> keys, instances;
    Buffer<Float4> hits;
    Buffer<Vec2> motion;
};

/// Motion vectors of the picture: two channels, pixels to the right and up. `camera_before` is the camera of the
/// previous frame, of the same size, in which objects were where `before` says. Throws Error(OutOfMemory,
/// DeviceFault).
Image motion_vectors(Queue& queue, SceneTracer& tracer, const PictureView& picture, const CameraView& camera_before,
                     const PreviousScene& before);

} // namespace pertev
