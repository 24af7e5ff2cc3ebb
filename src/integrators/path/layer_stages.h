#pragma once

// The stages of a wavefront whose light goes to layers of light-path expressions too, or whose picture is one of
// irradiance: in place of ShadeHits, and after AddLight.

#include "device/launch.h"
#include "integrators/path/generate_path.h"
#include "integrators/path/path_queues.h"
#include "integrators/path/shade_to_layers.h"

namespace pertev {

/// Beside the queues of paths and shadow rays.
struct LayerQueueView {
    Uint2 *states, *next_states; // LightPathState, beside the arrays of paths that a round reads and writes
    Float4* shadow_diffuse;      // LayerShadow's, bits of the pixel
    Uint4* shadow_parts;         // its state, column and light

    static constexpr std::size_t kBytesOfPath = 2 * sizeof(Uint2) + sizeof(Float4) + sizeof(Uint4);
};

/// `kMotion`: as shade_hit has it.
template <MotionKnown kMotion>
struct ShadeHitsToLayers {
    PictureView picture;
    PathSettings settings;
    FilmView film;
    LightPathView layers; // may be none
    bool is_meter;        // shade_hit_to_layers'
    PathQueueView paths, next;
    LayerQueueView layered;
    HitQueueView hits;
    ShadowQueueView shadows;
    RoundCounts* round;
    uint32_t last; // ShadeHits'

    static constexpr BlockShape kShape = {128, 1};

    HD INLINE_ON_DEVICE void operator()(uint32_t i, bool is_there) const {
        const RoundLists lists;
        PathState path;
        LightPathState state = layers.begin();
        ShadowRay shadow;
        LayerShadow parts;
        TriangleId here;
        uint32_t key = 0;
        bool goes_on = false, wants_shadow = false;
        if (is_there) {
            const uint32_t place = i < round->going_on ? i : last - (i - round->going_on);
            path = paths.load(place);
            if (kMotion != MotionKnown::None || (path.depth == 0 && picture.camera.motion.moves())) {
                path.time = time_of(picture.camera, settings, path);
            }
            const Hit hit = hits.load(place);
            key = path_key(path, settings.seed, true);
            here = {hit.instance, hit.primitive};
            if (layers.is_there() && path.depth > 0) state = {layered.states[place].x, layered.states[place].y};
            goes_on = shade_hit_to_layers<kMotion>(picture, settings, film, layers, is_meter, state, path, hit,
                                                   DrawWhenAsked(), shadow, wants_shadow, parts);
        }
        const auto [to, ray] = take_places(lists, *round, last, is_there, goes_on, wants_shadow);
        if (!is_there) return;
        if (goes_on) {
            next.store(to, path, settings.seed, picture.scene.any_alpha != 0);
            if (kMotion != MotionKnown::None) next.times[to] = path.time;
            if (layers.is_there()) layered.next_states[to] = {state.red_green, state.blue};
        } else {
            next.store_ended(to, path);
        }
        if (!wants_shadow) return;
        shadows.store<false>(ray, shadow, to, path.pixel, here, key);
        if (kMotion != MotionKnown::None) shadows.times[ray] = path.time;
        if (!layers.is_there()) return;
        layered.shadow_diffuse[ray] = {parts.diffuse.r, parts.diffuse.g, parts.diffuse.b, float_of(path.pixel)};
        layered.shadow_parts[ray] = {parts.state.red_green, parts.state.blue, parts.column, parts.light};
    }
};

/// Light whose shadow ray met nothing.
struct AddLightToLayers {
    ShadowQueueView shadows; // AddLight's
    FilmView film;
    LightPathView layers;
    LayerQueueView layered;

    HD void operator()(uint32_t i) const {
        if (shadows.keys[i] != kNoHit) return;
        const Float4 c = shadows.contribution[i], d = layered.shadow_diffuse[i];
        const Uint4 p = layered.shadow_parts[i];
        add_to_layers(layers, film, bits_of(d.w), {{d.x, d.y, d.z}, {p.x, p.y}, p.z, p.w}, {c.x, c.y, c.z});
    }
};

} // namespace pertev
