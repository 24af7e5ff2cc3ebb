#pragma once

// Traces the camera rays of samples once more, and lets a film's targets take
// what they hit. The rays, and the random numbers of blended surfaces, are
// those of the samples, so a layer belongs to its picture by any integrator.

#include "device/buffer.h"
#include "device_scene/accept_hit.h"
#include "device_scene/ray_queue.h"
#include "render/begin_order.h"
#include "render/picture_view.h"
#include "render/sample_layers/first_hit_targets.h"
#include "render/sample_layers/matte_names.h"
#include "render/sample_layers/pixel_matte.h"
#include "tracer/scene_tracer.h"

namespace pertev {

/// The stage that makes the rays [first, ...) of a sample in the order of
/// BeginOrder.
struct MakeSampleRays {
    CameraRays camera;
    SamplerKind sampler;
    uint32_t seed, sample;
    PixelWindow window;
    uint32_t first;
    Ray* rays;
    uint32_t* keys; // null if no surface is blended
    float* times;   // null if nothing but cameras moves

    HD void operator()(uint32_t i) const {
        const SampleKey key = {BeginOrder{window, 0, 1}.pixel(first + i), sample, seed};
        store_ray(rays + i, camera.ray(key.stream, sampler, key));
        if (keys != nullptr) keys[i] = coin_key(key, 0, false);
        if (times != nullptr) times[i] = camera.time(sampler, key);
    }
};

/// Arrays of targets, over the pixels of a window; null where a layer is not
/// requested.
struct FirstHitArrays {
    UvSum* uv = nullptr;
    PixelMatte *objects = nullptr, *materials = nullptr;
    bool are_empty() const { return uv == nullptr && objects == nullptr && materials == nullptr; }
};

/// The stage that counts samples, with one call per pixel.
struct CountSamples {
    uint32_t* counts;
    uint32_t samples;

    HD void operator()(uint32_t i) const { counts[i] += samples; }
};

/// The stage that adds the hits of these rays. Each pixel has one.
struct AddFirstHits {
    SceneView scene;
    HitQueueView hits;
    PixelWindow window;
    uint32_t first;
    const uint32_t *object_ids, *material_ids; // MatteNames
    FirstHitArrays into;

    HD void operator()(uint32_t i) const {
        const Hit hit = hits.load(i);
        const auto slot = static_cast<uint64_t>(window.slot_of(BeginOrder{window, 0, 1}.pixel(first + i)));
        if (shows_background(scene, hit.instance)) return;
        const InstanceView& instance = scene.instances[hit.instance];
        if (into.objects != nullptr) into.objects[slot].take(object_ids[hit.instance], 1);
        if (into.materials != nullptr) into.materials[slot].take(material_ids[instance.material], 1);
        if (into.uv != nullptr) add_uv(into.uv[slot], scene.meshes[instance.mesh], hit);
    }

private:
    HD static void add_uv(UvSum& sum, const MeshView& mesh, const Hit& hit) {
        if (mesh.uv[0] == nullptr) return;
        const Vec2 uv = interpolate(mesh.uv[0], triangle_indices(mesh, hit.primitive), hit.u, hit.v);
        if (!is_valid_sample(uv.x) || !is_valid_sample(uv.y)) return;
        sum = {sum.u + to_fixed(uv.x), sum.v + to_fixed(uv.y), sum.hits + to_fixed(1.0f)};
    }
};

/// Finds first hits and holds the memory for their rays.
class FirstHits {
public:
    /// Makes an object without memory; `queue` outlives it.
    explicit FirstHits(Queue& queue) : queue_(queue), at_once_(queue.is_cuda() ? 1u << 20 : 1u << 15) {}

    /// Allocates what a window of so many pixels needs, and keeps it. add() calls
    /// it. Throws Error(OutOfMemory).
    void reserve(uint64_t pixels, bool has_times);
    /// Adds the first hits and the number of samples [first, first + count) of
    /// the pixels of `film.view()` to the film's targets, if it has any for them.
    /// `names` are those of the scene, if the film has mattes. Throws
    /// Error(OutOfMemory, DeviceFault).
    void add(const PictureView& picture, SceneTracer& tracer, SamplerKind sampler, uint32_t seed,
             const std::shared_ptr<const MatteNames>& names, uint32_t first, uint32_t count, const Film& film);

private:
    void upload(const std::shared_ptr<const MatteNames>& names);

    Queue& queue_;
    uint32_t at_once_; // pixels; a CPU keeps their rays in its caches
    Buffer<Ray> rays_;
    Buffer<uint32_t> keys_, instances_;
    Buffer<float> times_;
    Buffer<Float4> records_;
    std::shared_ptr<const MatteNames> names_; // the device has their ids
    Buffer<uint32_t> object_ids_, material_ids_;
};

} // namespace pertev
