#pragma once

// PathRounds is a schedule for tests over the functions of the path tracer, besides the product's two. It renders one
// sample of all pixels at a time. Each stage runs over all pixels, and the scene's tracer traces their rays. A path
// that has ended keeps its index, with a ray that hits nothing. Thus any job, mask of features and listeners can be
// rendered on either device without code in the product.

#include "device/buffer.h"
#include "integrators/path/generate_path.h"
#include "integrators/path/path_vertex.h"
#include "tracer/scene_tracer.h"

namespace pertev::test {

/// The rays of all pixels on a device, and the triangles at their starts and targets.
struct RoundRays {
    Ray* rays;
    Uint2 *starts, *targets;

    RayQueueView query() const { return {.rays = rays, .starts = starts, .targets = targets}; }
    HD void store(uint32_t i, const Ray& ray, TriangleId start, TriangleId target) const {
        rays[i] = ray;
        starts[i] = {start.instance, start.primitive};
        targets[i] = {target.instance, target.primitive};
    }
    /// Stores a ray that hits nothing.
    HD void store_none(uint32_t i) const { store(i, {{0, 0, 0}, 0, {0, 0, 1}, 0}, {}, {}); }
};

template <class Listener>
struct RoundPath {
    PathState state;
    typename Listener::PathData kept;
    typename Listener::ShadowData shadow_data;
    Rgb connection_light; // the shadow ray's light
    bool goes_on, has_shadow_ray;
};

template <class Listener>
struct RoundsView {
    RoundPath<Listener>* paths; // [pixels of the film]
    RoundRays continuation, shadows;
    HitQueueView hits, occlusions;

    HD void store_ray(uint32_t i) const {
        const PathState& path = paths[i].state;
        if (!paths[i].goes_on) return continuation.store_none(i);
        continuation.store(i, {path.origin, 0, path.direction, kInfinity}, path.start, {});
    }
};

template <class Listener, class Job>
struct BeginRound {
    Job job;
    RoundsView<Listener> view;
    uint32_t sample;

    HD void operator()(uint32_t i) const {
        RoundPath<Listener>& path = view.paths[i];
        path.state =
            generate_path(job.picture.camera, job.settings, nullptr, job.film.window.pixel_at(FilmSlot{i}), sample);
        path.goes_on = true;
        view.store_ray(i);
    }
};

template <Features kFeatures, class Listener, class Job>
struct ShadeRound {
    Job job;
    RoundsView<Listener> view;

    HD void operator()(uint32_t i) const {
        RoundPath<Listener>& path = view.paths[i];
        path.has_shadow_ray = false;
        view.shadows.store_none(i);
        if (!path.goes_on) return;
        Listener listener(job);
        if (path.state.depth == 0) {
            listener.begins(path.state);
        } else {
            listener.restore(path.kept);
        }
        ShadowRay shadow;
        const Hit hit = view.hits.load(i);
        path.goes_on =
            shade_vertex<kFeatures>(job, path.state, hit, DrawOnDemand(), shadow, path.has_shadow_ray, listener);
        listener.save(path.kept);
        view.store_ray(i);
        if (!path.has_shadow_ray) return;
        listener.save_shadow_data(path.shadow_data);
        path.connection_light = shadow.contribution;
        view.shadows.store(i, {shadow.origin, 0, shadow.direction, shadow.t_max}, shadow.start, shadow.target);
    }
};

template <class Listener, class Job>
struct AddRoundLight {
    Job job;
    RoundsView<Listener> view;

    HD void operator()(uint32_t i) const {
        RoundPath<Listener>& path = view.paths[i];
        if (!path.has_shadow_ray || view.occlusions.instances[i] != kNoHit) return;
        path.state.radiance += path.connection_light;
        Listener(job).arrived(path.kept, path.shadow_data, path.connection_light);
    }
};

template <class Listener, class Job>
struct EndRounds {
    Job job;
    RoundsView<Listener> view;

    HD void operator()(uint32_t i) const {
        const RoundPath<Listener>& path = view.paths[i];
        Listener(job).ended(path.state.pixel, path.state.radiance, path.kept);
    }
};

/// Code for scenes of opaque surfaces at rest.
template <Features kFeatures, class Listener, class Job = PathJob>
class PathRounds {
public:
    PathRounds(Queue& queue, uint32_t pixels)
        : queue_(queue), pixels_(pixels), paths_(queue, pixels, "rounds"), rays_(queue, 2 * pixels, "rounds"),
          triangles_(queue, 4 * pixels, "rounds"), records_(queue, pixels, "rounds"),
          instances_(queue, 2 * pixels, "rounds") {}

    /// Adds samples [first, end) of the job's picture to its film, of at most `pixels` pixels.
    void render(const Job& job, SceneTracer& tracer, uint32_t first, uint32_t end); // path_rounds_body.h

private:
    Queue& queue_;
    uint32_t pixels_;
    Buffer<RoundPath<Listener>> paths_;
    Buffer<Ray> rays_;
    Buffer<Uint2> triangles_;
    Buffer<Float4> records_;
    Buffer<uint32_t> instances_;
};

} // namespace pertev::test
