#pragma once

// The surfaces that the pixels of a frame see, made again from what the frame keeps of them: a place on a triangle, and
// the camera's ray, which follows from the pixel's and the frame's number. Where their instances have moved since, they
// are where these are now.

#include "device_scene/surface.h"
#include "math/float4.h"
#include "render/camera_rays.h"

namespace pertev {

struct PixelSurfaces {
    const Float4* place; // NoisyFrameView's
    CameraRays camera;
    SamplerKind sampler;
    uint32_t sample, seed; // of the frame

    HD bool is_there(uint32_t pixel) const { return bits_of(place[pixel].x) != kNoHit; }
    HD SampleKey key(uint32_t pixel) const { return {pixel, sample, seed}; }
    /// The coin of blended surfaces between what the pixel sees and what that sees: the one of its path's next ray.
    HD uint32_t coin(uint32_t pixel) const { return coin_key(key(pixel), 1, false); }
    HD Hit hit(uint32_t pixel) const {
        const Float4 p = place[pixel];
        return {0, p.z, p.w, bits_of(p.x), bits_of(p.y)};
    }
    /// Of the camera's ray, unit.
    HD Vec3 direction(uint32_t pixel) const { return camera.ray(pixel, sampler, key(pixel)).direction; }
    HD PlacedTriangle triangle(const SceneView& scene, uint32_t pixel) const {
        const Hit at = hit(pixel);
        const InstanceView& instance = scene.instances[at.instance];
        return place_triangle(instance, scene.meshes[instance.mesh], at);
    }
};

} // namespace pertev
