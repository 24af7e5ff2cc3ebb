#pragma once

// Reconstructs the surfaces that a frame's pixels see from the G-buffer: a point on a triangle, and the camera ray,
// which follows from the pixel's and the frame's number. Points move with instances that have moved since.

#include "device_scene/surface.h"
#include "render/camera_rays.h"
#include "render/noisy_frame_view.h"
#include "restir/receiver.h"

namespace pertev {

struct PixelSurfaces {
    GBufferView g_buffer;
    CameraRays camera;
    SamplerKind sampler;
    uint32_t sample, seed;                   // the frame's sample number and seed
    bool filters;                            // textures have mip-maps
    const DiffuseReceiver* stored = nullptr; // receivers by pixel; null if there are none yet

    HD bool is_there(uint32_t pixel) const { return bits_of(g_buffer.hit[pixel].x) != kNoHit; }
    HD SampleKey key(uint32_t pixel) const { return {pixel, sample, seed}; }
    /// Key of blended surfaces for rays from the pixel's surface, equal to that of its path's next ray.
    HD uint32_t coin(uint32_t pixel) const { return coin_key(key(pixel), 1, false); }
    HD Hit hit(uint32_t pixel) const {
        const Float4 p = g_buffer.hit[pixel];
        return {0, p.z, p.w, bits_of(p.x), bits_of(p.y)};
    }
    /// Direction of the pixel's camera ray, unit.
    HD Vec3 direction(uint32_t pixel) const {
        CameraRays straight = camera; // frames have no other lens; saying so spares registers
        straight.view.lens = {};
        return straight.ray(pixel, sampler, key(pixel)).direction;
    }
    /// The pixel's surface, seen along `direction`, which is that of its path.
    template <ShadingVariant kVariant>
    HD Surface surface(const SceneView& scene, uint32_t pixel, Vec3 seen_along) const {
        const float distance = g_buffer.normal[pixel].w / dot(seen_along, camera.axis);
        return make_surface<kVariant>(scene, hit(pixel), seen_along, filters ? camera.pixel_width(distance) : 0.0f);
    }
    template <ShadingVariant kVariant>
    HD Receiver<kVariant> make_receiver(const SceneView& scene, uint32_t pixel) const {
        const Vec3 seen_along = direction(pixel);
        if constexpr (kVariant == ShadingVariant::Diffuse) {
            return diffuse_receiver(surface<kVariant>(scene, pixel, seen_along), -seen_along);
        } else {
            return {surface<kVariant>(scene, pixel, seen_along), -seen_along};
        }
    }
    template <ShadingVariant kVariant>
    HD Receiver<kVariant> receiver(const SceneView& scene, uint32_t pixel) const {
        if constexpr (kVariant == ShadingVariant::Diffuse) {
            if (stored != nullptr) return stored[pixel];
        }
        return make_receiver<kVariant>(scene, pixel);
    }
    HD WorldTriangle triangle(const SceneView& scene, uint32_t pixel) const {
        const Hit at = hit(pixel);
        const InstanceView& instance = scene.instances[at.instance];
        return world_triangle(instance, scene.meshes[instance.mesh], at);
    }
};

} // namespace pertev
