#pragma once

// Stages of a wavefront of paths, in the order in which path_integrator.cpp launches them. Each does for one index
// what the CPU's loop does in one line, by the same functions.

#include "device/launch.h"
#include "integrators/path/frame_listeners.h"
#include "integrators/path/generate_path.h"
#include "integrators/path/layer_listeners.h"
#include "integrators/path/order_hits.h"
#include "integrators/path/path_queues.h"
#include "integrators/path/path_vertex.h"
#include "render/begin_order.h"

namespace pertev {

/// The stage that plans a round in one thread: as many new paths as there is room for, until `samples` have begun.
struct PlanRound {
    const RoundCounts* before;
    RoundCounts* round;
    HostCounts* seen;
    RenderCounts* render; // shared by concurrent wavefronts
    uint32_t capacity;
    uint64_t samples;

    HD void operator()(uint32_t) const {
        const uint32_t going_on = before->next;
        const uint32_t free = (capacity - going_on) / 32 * 32; // whole warps, so that their camera rays stay together
        const uint64_t first = atomic_add(&render->begun, uint64_t(free));
        const uint64_t left = first < samples ? samples - first : 0;
        const uint32_t fresh = left < free ? static_cast<uint32_t>(left) : free;
        atomic_add(&render->bounces, uint64_t(going_on));
        atomic_add(&render->shadows, uint64_t(before->shadows));
        *round = {};
        round->going_on = going_on;
        round->fresh = fresh;
        round->active = going_on + fresh;
        round->first = first;
        round->all_begun = left <= free ? 1 : 0;
        *seen = {round->active, round->all_begun};
    }
};

/// The stage that begins paths, of one picture or of a batch.
template <bool kInBatch>
struct GeneratePaths {
    PathJob job;
    BeginOrder samples;
    const RoundCounts* round;
    uint32_t last; // slot of the first one
    bool any_alpha;
    PathQueueView paths;

    HD void operator()(uint32_t i) const { begin_and_store(i); }
    /// Begins a path, stores it and returns its camera ray.
    HD Ray begin_and_store(uint32_t i) const {
        const PixelSample begun = samples.at(round->first + i);
        constexpr Features kFeatures = kInBatch ? Features{kBatched} : Features{0};
        const PathState path = begin(begun);
        paths.store_begun(last - i, path, sample_key<kFeatures>(job, path.pixel, path.sample), any_alpha);
        if (paths.times != nullptr) paths.times[last - i] = path.time;
        return {path.origin, 0.0f, path.direction, kInfinity};
    }

private:
    HD PathState begin(const PixelSample& begun) const {
        if (kInBatch) return generate_path(job.picture.batch, job.settings.sampler, begun.pixel, begun.sample);
        return generate_path(job.picture.camera, job.settings, job.film.frame.aims, begun.pixel, begun.sample);
    }
};

/// Returns whether the hits of a round are sorted by shading group before they are shaded. Code without stacked
/// materials needs fewer fetches, and there each block sorts its own hits.
constexpr bool orders_hits(Features features) { return (features & kStacked) != 0; }

/// The stage that shades the hits of paths, with the least code that the features need, for `Listener`. Where
/// surfaces have several kinds of lobes, the paths are sorted by what they hit.
template <Features kFeatures, class Listener>
struct Shade {
    PathJob job;
    PathQueueView paths, next;
    HitQueueView hits;
    ShadowQueueView shadows;
    ListenerQueues listened;
    RoundCounts* round;
    uint32_t last;         // slot of the first new path, and of the first one that ends after its shadow ray
    const uint32_t* order; // the round's paths by shading group, if orders_hits(kFeatures)

    // Measured (docs/performance.md). For large code, warps that wait for each other fetch it together, unless hits of
    // one group follow each other.
    static constexpr BlockShape kShape = Listener::template has<LightPaths>     ? BlockShape{128, 1}
                                         : (kFeatures & kAllMaterials) == 0     ? BlockShape{128, 6}
                                         : (kFeatures & kLayered) == 0          ? BlockShape{512, 2}
                                         : orders_hits(kFeatures)               ? BlockShape{128, 4}
                                         : Listener::template has<FrameSurface> ? BlockShape{512, 1}
                                                                                : BlockShape{384, 2};

    HD INLINE_ON_DEVICE void operator()(uint32_t i, bool is_there) const {
        constexpr bool kMoves = (kFeatures & kMoving) != 0;
        const RoundHits found = {hits, round, last};
        if constexpr (orders_hits(kFeatures)) {
            if (is_there) i = order[i];
        } else if constexpr ((kFeatures & kLayered) != 0) {
            i = sorted_in_block<kShape.threads>(i, is_there ? found.group_of(job.picture.scene, i) : kBlockKeys - 1);
        }
        const RoundAppend lists;
        Listener listener(job);
        PathState path;
        ShadowRay shadow;
        uint32_t key = 0;
        bool goes_on = false, has_shadow_ray = false;
        if (is_there) {
            const bool begins = i >= round->going_on;
            const uint32_t slot = found.slot_of(i);
            path = begins ? paths.load_begun(slot, job.picture.camera) : paths.load(slot);
            const SampleKey of_sample = sample_key<kFeatures>(job, path.pixel, path.sample);
            if ((kFeatures & kStacked) != 0 && !begins) path.start = paths.start_of(slot);
            if constexpr ((kFeatures & kNested) != 0) path.interior = interior_of(path.pixel, slot, begins);
            if constexpr (LightChoice<kFeatures>::kReadsNormal) path.normal = begins ? Vec3{} : paths.normals[slot];
            if ((kFeatures & kMedia) != 0 && paths.passed != nullptr) path.passed = begins ? 0.0f : paths.passed[slot];
            if (kMoves) path.time = job.picture.camera.time(job.settings.sampler, of_sample);
            const Hit hit = hits.load(slot);
            key = coin_key(of_sample, path.depth, true);
            if (begins) {
                listener.begins(path);
            } else {
                typename Listener::PathData kept{};
                Listener::load(listened, slot, kept);
                listener.restore(kept);
            }
            const bool is_tall = (kFeatures & kBatched) != 0 && job.picture.batch.is_there();
            const DrawOnDemand numbers = {is_tall ? &job.picture.batch : nullptr};
            goes_on = shade_vertex<kFeatures>(job, path, hit, numbers, shadow, has_shadow_ray, listener);
        }
        const RoundSlots slots = append_to_round(lists, *round, last, goes_on, has_shadow_ray);
        if (!is_there) return;
        typename Listener::PathData kept{};
        listener.save(kept);
        if (!goes_on && !has_shadow_ray) return listener.ended(path.pixel, path.radiance, kept);
        if (goes_on) {
            next.store(slots.path, path, sample_key<kFeatures>(job, path.pixel, path.sample),
                       scene_of<kFeatures>(job, path.pixel).any_alpha != 0);
            if (kMoves && next.times != nullptr) next.times[slots.path] = path.time;
            if constexpr (LightChoice<kFeatures>::kReadsNormal) next.normals[slots.path] = path.normal;
            if ((kFeatures & kMedia) != 0 && next.passed != nullptr) next.passed[slots.path] = path.passed;
            if ((kFeatures & kNested) != 0 && next.interiors != nullptr) {
                next.interiors[slots.path] = path.interior.words();
            }
        } else {
            next.store_ended(slots.path, path);
        }
        Listener::store_next(listened, slots.path, kept);
        if (!has_shadow_ray) return;
        shadows.store(slots.shadow, shadow, slots.path | (goes_on ? 0 : kEndsPath), key);
        if (kMoves && shadows.times != nullptr) shadows.times[slots.shadow] = path.time;
        typename Listener::ShadowData shadow_data{};
        listener.save_shadow_data(shadow_data);
        Listener::store_shadow_data(listened, slots.shadow, shadow_data);
    }

private:
    HD InteriorList interior_of(uint32_t pixel, uint32_t slot, bool begins) const {
        if (!begins) return paths.interiors != nullptr ? InteriorList::of_words(paths.interiors[slot]) : InteriorList{};
        const bool has_batch = (kFeatures & kBatched) != 0 && job.picture.batch.is_there();
        if (has_batch) return job.picture.batch.camera_of(pixel).interior;
        return job.picture.camera.interior;
    }
};

/// The stage that adds the light of unoccluded shadow rays, and the paths that have ended by then to the film.
template <class Listener>
struct AddLight {
    PathJob job;
    ShadowQueueView shadows; // keys hold the tracer's results, kNoHit if the ray hit nothing
    PathQueueView next;
    ListenerQueues listened;

    HD void operator()(uint32_t i) const {
        const Float4 c = shadows.contribution[i];
        const uint32_t slot = bits_of(c.w) & ~kEndsPath;
        const bool arrives = shadows.keys[i] == kNoHit, ends = (bits_of(c.w) & kEndsPath) != 0;
        if (!arrives && !ends) return;
        const Listener listener(job);
        typename Listener::PathData kept{};
        Listener::load_next(listened, slot, kept);
        const Float4 before = next.radiance[slot];
        Rgb radiance = {before.x, before.y, before.z};
        if (arrives) {
            const Rgb light = {c.x, c.y, c.z};
            typename Listener::ShadowData shadow_data{};
            Listener::load_shadow_data(listened, i, shadow_data);
            radiance += light;
            listener.arrived(kept, shadow_data, light);
        }
        if (ends) return listener.ended(bits_of(before.w), radiance, kept);
        next.radiance[slot] = {radiance.r, radiance.g, radiance.b, before.w};
        Listener::store_next(listened, slot, kept);
    }
};

} // namespace pertev
