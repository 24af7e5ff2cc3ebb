#pragma once

// The stages of a wavefront of paths, in the order in which path_integrator.cpp launches them. Each does for one index
// what the CPU's loop does in one line, through the same functions.

#include "device/launch.h"
#include "integrators/path/generate_path.h"
#include "integrators/path/path_queues.h"
#include "integrators/path/shade_hit.h"
#include "render/begin_order.h"

namespace pertev {

/// One thread decides what a round does: as many new paths as there is room for, until `samples` have begun.
struct PlanRound {
    const RoundCounts* before;
    RoundCounts* round;
    SeenCounts* seen;
    RenderCounts* render; // shared by several that go round at once
    uint32_t capacity;
    uint64_t samples;

    HD void operator()(uint32_t) const {
        const uint32_t going_on = before->next;
        const uint32_t room = (capacity - going_on) / 32 * 32; // whole warps: their camera rays stay together
        const uint64_t first = atomic_add(&render->begun, uint64_t(room));
        const uint64_t left = first < samples ? samples - first : 0;
        const uint32_t fresh = left < room ? static_cast<uint32_t>(left) : room;
        atomic_add(&render->bounces, uint64_t(going_on));
        atomic_add(&render->shadows, uint64_t(before->shadows));
        *round = {};
        round->going_on = going_on;
        round->fresh = fresh;
        round->active = going_on + fresh;
        round->first = first;
        round->all_begun = left <= room ? 1 : 0;
        *seen = {round->active, round->all_begun};
    }
};

struct GeneratePaths {
    CameraRays camera;
    PathSettings settings;
    BeginOrder samples;
    const RoundCounts* round;
    uint32_t last; // place of the first one
    bool any_alpha;
    PathQueueView paths;

    HD void operator()(uint32_t i) const {
        const PixelSample begun = samples.at(round->first + i, camera.width, camera.height);
        const PathState path = generate_path(camera, settings, begun.pixel, begun.sample);
        paths.store(last - i, path, settings.seed, any_alpha);
        if (paths.times != nullptr) paths.times[last - i] = path.time;
    }
};

/// `kMayBeFrame`, `kMayLeave`, `kMotion`: as shade_hit has them.
template <MaterialsKnown kKnown, bool kMayBeFrame, bool kMayLeave, MotionKnown kMotion>
struct ShadeHits {
    PictureView picture;
    PathSettings settings;
    FilmView film;
    PathQueueView paths, next;
    HitQueueView hits;
    ShadowQueueView shadows;
    RoundCounts* round;
    uint32_t last; // place of the first fresh path, and of the first one that ends

    // Measured (docs/performance.md). Where there is much code, warps that wait for each other fetch it together.
    static constexpr BlockShape kShape = kKnown == MaterialsKnown::PlainDiffuse ? BlockShape{128, 6}
                                         : kKnown == MaterialsKnown::Diffuse    ? BlockShape{512, 2}
                                         : kMayBeFrame                          ? BlockShape{512, 1}
                                                                                : BlockShape{384, 2};

    HD INLINE_ON_DEVICE void operator()(uint32_t i, bool is_there) const {
        const RoundLists lists;
        const bool splits_light = kMayBeFrame && kKnown == MaterialsKnown::Nothing && paths.diffuse != nullptr;
        PathState path;
        LightSplit split;
        ShadowRay shadow;
        TriangleId here;
        uint32_t key = 0;
        bool goes_on = false, wants_shadow = false;
        if (is_there) {
            const uint32_t place = i < round->going_on ? i : last - (i - round->going_on);
            path = paths.load(place);
            if (kMotion != MotionKnown::None) path.time = time_of(picture.camera, settings, path);
            const Hit hit = hits.load(place);
            key = path_key(path, settings.seed, true);
            here = {hit.instance, hit.primitive};
            if (splits_light) split.take_out(path, path.depth > 0 ? paths.diffuse[place] : Float4{0, 0, 0, 0});
            goes_on = shade_hit<kKnown, kMayBeFrame, kMayLeave, kMotion>(picture, settings, film, path, hit,
                                                                         DrawWhenAsked(), shadow, wants_shadow);
            if (splits_light) split.put_back(path);
        }
        const RoundPlaces places = take_places(lists, *round, last, is_there, goes_on, wants_shadow);
        if (!is_there) return;
        if (goes_on) {
            next.store(places.path, path, settings.seed, picture.scene.any_alpha != 0);
            if (keeps_times(next.times)) next.times[places.path] = path.time;
        } else {
            next.store_ended(places.path, path);
        }
        if (splits_light) next.diffuse[places.path] = split.diffuse;
        if (wants_shadow) {
            shadows.store<kMayLeave>(places.shadow, shadow, places.path, path.pixel, here, key);
            if (keeps_times(shadows.times)) shadows.times[places.shadow] = path.time;
        }
    }

private:
    HD static bool keeps_times(const float* times) {
        return kMotion == MotionKnown::Some || (kMotion == MotionKnown::Perhaps && times != nullptr);
    }
};

/// Light whose shadow ray met nothing.
struct AddLight {
    ShadowQueueView shadows; // keys: what a tracer found, kNoHit where the ray met nothing
    PathQueueView next;
    FirstBounceView first_bounce;

    HD void operator()(uint32_t i) const {
        if (shadows.keys[i] != kNoHit) return;
        const Float4 c = shadows.contribution[i];
        next.add_radiance(bits_of(c.w), {c.x, c.y, c.z});
        if (shadows.diffuse != nullptr) next.add_diffuse(bits_of(c.w), shadows.diffuse[i]);
        if (shadows.sent != nullptr) {
            const Float4 sent = shadows.sent[i];
            first_bounce.add_sent(bits_of(sent.w), {sent.x, sent.y, sent.z});
        }
    }
};

/// Paths that have ended.
struct AddToFilm {
    FilmView film;
    PathQueueView next;
    uint32_t last; // place of the first one

    HD void operator()(uint32_t i) const {
        const uint32_t pixel = next.load_pixel(last - i);
        const Rgb radiance = next.load_radiance(last - i);
        if (film.frame.is_there()) {
            store_sample(film, pixel, radiance, next.load_diffuse(last - i));
        } else {
            add_radiance(film, pixel, radiance);
        }
    }
};

} // namespace pertev
