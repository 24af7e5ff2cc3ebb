#pragma once

// Auxiliary layers at the centres of pixels: the values where the ray through the centre hits, without lens, pixel
// filter or blending, in the middle of the shutter's open time. A blended surface counts or not by the random number
// of sample 0. Where nothing is hit, values are 0, as in means over samples (render/first_hit.h).

#include "device/buffer.h"
#include "device_scene/moved_surface.h"
#include "device_scene/ray_queue.h"
#include "render/begin_order.h"
#include "render/centre_arrays.h"
#include "render/film_view.h"
#include "render/picture_view.h"
#include "tracer/scene_tracer.h"

namespace pertev {

/// The stage that makes the rays [first, ...) in the order of BeginOrder, with the pixel and the time in place of t_min
/// and t_max.
struct MakeCentreRays {
    PictureView picture;
    uint32_t seed; // the seed, unless the picture is a batch
    PixelWindow window;
    uint32_t first;
    Ray* rays;
    uint32_t* keys; // null if no surface is blended
    float* times;   // null if nothing but cameras moves

    HD void operator()(uint32_t i) const {
        const uint32_t pixel = BeginOrder{window, 0, 1}.pixel(first + i);
        const BatchView& batch = picture.batch;
        if (!batch.is_there()) return store(i, pixel, picture.camera, {pixel, 0, seed});
        store(i, pixel, batch.camera_of(pixel), batch.key(pixel, 0));
    }

private:
    HD void store(uint32_t i, uint32_t pixel, const CameraRays& camera, const SampleKey& key) const {
        const float time = camera.is_open ? 0.5f : kAtRest;
        const Ray ray = camera.centre_ray(key.stream, time);
        store_ray(rays + i, {ray.origin, float_of(pixel), ray.direction, time});
        if (keys != nullptr) keys[i] = coin_key(key, 0, false);
        if (times != nullptr) times[i] = time;
    }
};

/// The stage that stores the layers of these rays' pixels. The features are as in make_surface and MovedHit.
template <ShadingVariant kVariant, bool kMoves>
struct StoreCentres {
    PictureView picture;
    const Ray* rays;
    HitQueueView hits;
    PixelWindow window;
    CentreArrays into;

    HD void operator()(uint32_t i) const {
        const Hit hit = hits.load(i);
        const Ray ray = load_ray(rays + i);
        const auto slot = static_cast<uint64_t>(window.slot_of(bits_of(ray.t_min)));
        const SceneView& scene = picture.scene_of(bits_of(ray.t_min));
        if (shows_background(scene, hit.instance)) return store_none(slot);
        const float time = ray.t_max;
        const MovedHit moved(scene, hit, kMoves ? time : kAtRest);
        const InstanceView& instance = scene.instances[hit.instance];
        const MeshView& mesh = scene.meshes[instance.mesh];
        const MaterialParameters& material = scene.materials[instance.material];
        const WorldTriangle triangle = world_triangle(instance, mesh, hit);
        if (into.albedo != nullptr) {
            const Rgb albedo = base_color_at<kVariant>(scene, material, mesh, triangle.i, hit.u, hit.v);
            store(into.albedo, slot, {albedo.r, albedo.g, albedo.b});
        }
        if (into.normal != nullptr) {
            float tilt;
            const Vec3 wo = -(kMoves ? moved.back(ray.direction) : ray.direction);
            const Vec3 still = shading_frame<kVariant>(scene, instance, mesh, material, triangle, hit,
                                                       front_normal(instance, mesh, triangle), wo, tilt)
                                   .normal;
            const Vec3 normal = kMoves && moved.moves ? moved.motion.rotate(still) : still;
            store(into.normal, slot, dot(normal, ray.direction) > 0 ? -normal : normal);
        }
        const Vec3 at_rest = triangle.at(hit.u, hit.v); // on the ray; WorldTriangle::position is kept off edges
        const Vec3 position = kMoves && moved.moves ? moved.motion.move(at_rest) : at_rest;
        if (into.depth != nullptr) {
            const Vec3 axis = picture.axis_at(bits_of(ray.t_min), time);
            into.depth[slot] = valid(dot(position - ray.origin, axis));
        }
        if (into.distance != nullptr) into.distance[slot] = valid(length(position - ray.origin));
        if (into.position != nullptr) store(into.position, slot, position + scene.position_shift);
        if (into.ids != nullptr) into.ids[slot] = {hit.instance, hit.primitive, instance.material};
    }

private:
    HD static float valid(float x) { return is_valid_sample(x) ? x : 0.0f; }
    HD static void store(float* layer, uint64_t slot, Vec3 value) {
        float* const to = layer + 3 * slot;
        to[0] = valid(value.x), to[1] = valid(value.y), to[2] = valid(value.z);
    }
    HD void store_none(uint64_t slot) const {
        if (into.albedo != nullptr) store(into.albedo, slot, {0, 0, 0});
        if (into.normal != nullptr) store(into.normal, slot, {0, 0, 0});
        if (into.depth != nullptr) into.depth[slot] = 0;
        if (into.distance != nullptr) into.distance[slot] = 0;
        if (into.position != nullptr) store(into.position, slot, {0, 0, 0});
        if (into.ids != nullptr) into.ids[slot] = {kNoHit, kNoHit, kNoHit};
    }
};

/// Finds the layers, by a few launches for many pixels, and holds the memory for their rays.
class CentreLayers {
public:
    /// Makes an object without memory; `queue` outlives it.
    explicit CentreLayers(Queue& queue) : queue_(queue), at_once_(queue.is_cuda() ? 1u << 20 : 1u << 15) {}

    /// Allocates what windows of up to `pixels` pixels need, with the times of rays if `has_times`, and keeps it.
    /// find() calls it. Throws Error(OutOfMemory).
    void reserve(uint64_t pixels, bool has_times);
    /// Finds the layers of a window of the picture, or of its batch. The work is queued and may still run on return.
    /// `seed` is that of a picture that is not in a batch. Throws Error(OutOfMemory, DeviceFault).
    void find(const PictureView& picture, SceneTracer& tracer, uint32_t seed, const PixelWindow& window,
              const CentreArrays& into);

private:
    Queue& queue_;
    uint32_t at_once_; // pixels; a CPU keeps their rays in its caches
    Buffer<Ray> rays_;
    Buffer<uint32_t> keys_, instances_;
    Buffer<float> times_;
    Buffer<Float4> records_;
};

} // namespace pertev
