#pragma once

// Contacts: where another surface is close above the surface of a pixel. Light changes there within few pixels, which
// no guide of the G-buffer shows, and with things that move it changes from frame to frame. A short ray along the
// normal finds this without noise, whatever the light. In frames of moving scenes the result is part of a pixel's
// guide, so that neither history nor neighbours mix light of both sides.

#include "denoise/reconstruction_view.h"
#include "device_scene/surface.h"
#include "render/noisy_frame.h"
#include "render/row_band.h"
#include "tracer/scene_tracer.h"

namespace pertev {

/// The stage that makes the ray of each pixel from `first` on.
struct ContactRays {
    GBufferView frame;
    SceneView scene;
    CameraView camera;
    float reach; // height up to which another surface counts, in pixels
    uint32_t first;
    Ray* rays;
    Uint2* starts;
    uint32_t* keys;

    HD void operator()(uint32_t i) const {
        const uint32_t pixel = first + i;
        const Float4 at = frame.hit[pixel], normal = frame.normal[pixel];
        const Hit hit = {0, at.z, at.w, bits_of(at.x), bits_of(at.y)};
        Ray ray = {.origin = {0, 0, 0}, .direction = {0, 0, 1}};
        ray.t_max = 0; // hits nothing
        if (hit.instance != kNoHit) {
            const InstanceView& instance = scene.instances[hit.instance];
            const WorldTriangle triangle = world_triangle(instance, scene.meshes[instance.mesh], hit);
            const bool is_front = dot(triangle.normal, vec3_of(normal)) >= 0;
            ray.direction = is_front ? triangle.normal : -triangle.normal;
            ray.origin = offset_ray_origin(triangle.position, triangle.error, triangle.normal, ray.direction);
            ray.t_max = reach * pixel_size(camera, normal.w);
        }
        store_ray(rays + i, ray);
        starts[i] = {hit.instance, hit.primitive};
        keys[i] = hash_words(pixel, 0, 0, 0).x;
    }
};

/// The stage that marks the pixels whose ray has hit something.
struct StoreContacts {
    GBufferView frame;
    const uint32_t* found; // HitQueueView::instances
    uint32_t first;

    HD void operator()(uint32_t i) const { store_contact(frame, first + i, found[i] != kNoHit); }
};

/// Finds the contacts of a frame's pixels.
class ContactFinder {
public:
    /// Makes a finder for frames of this size.
    ContactFinder(Queue& queue, uint32_t width, uint32_t height);

    /// Marks the pixels of `rows` of `frame` (contact_of), seen by `camera` in `scene`. `scale` is the size of its
    /// pixels over that of those of full frames. Throws Error(DeviceFault).
    void find(const NoisyFrame& frame, const CameraView& camera, const SceneView& scene, SceneTracer& tracer,
              RowBand rows, float scale = 1);

private:
    /// Height up to which another surface counts, in pixels of full frames: as far as the wavelet passes reach.
    static constexpr float kReach = 32;

    Queue* queue_;
    uint32_t most_; // pixels per batch
    Buffer<Ray> rays_;
    Buffer<Uint2> starts_;
    Buffer<uint32_t> keys_, found_;
};

} // namespace pertev
