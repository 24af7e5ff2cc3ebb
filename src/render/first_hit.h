#pragma once

// Auxiliary channels of the camera ray's first hit, the same for all integrators.

#include "device_scene/surface.h"
#include "render/film_view.h"
#include "render/picture_view.h"

namespace pertev {

/// Adds the channels of a camera ray that hit nothing.
HD inline void add_no_first_hit(const FilmView& film, uint32_t pixel, uint32_t sample) {
    if ((film.aovs & kAovIds) != 0 && sample == 0) film.set_ids(pixel, {kNoHit, kNoHit, kNoHit});
}

/// Adds the channels of `hit` that need no surface. Returns false for a generated ground, which counts as background.
HD inline bool add_first_hit(const FilmView& film, uint32_t pixel, uint32_t sample, const Hit& hit,
                             const PictureView& picture) {
    if (shows_background(picture.scene, hit.instance)) {
        add_no_first_hit(film, pixel, sample);
        return false;
    }
    add_channel(film, pixel, kFilmHits, 1.0f);
    return true;
}

/// Adds the channels of `hit` with its `surface`. `time` is the ray's while the shutter is open.
HD inline void add_first_hit(const FilmView& film, uint32_t pixel, uint32_t sample, const RayLine& ray, const Hit& hit,
                             const Surface& surface, const PictureView& picture, float time = kAtRest) {
    if (!add_first_hit(film, pixel, sample, hit, picture)) return;
    if ((film.aovs & kAovAlbedo) != 0) {
        add_channels(film, pixel, channel_offset(film.aovs, kAovAlbedo),
                     {surface.albedo.r, surface.albedo.g, surface.albedo.b});
    }
    if ((film.aovs & kAovNormal) != 0) {
        const Vec3 normal = surface.frame.normal;
        add_channels(film, pixel, channel_offset(film.aovs, kAovNormal),
                     dot(normal, ray.direction) > 0 ? -normal : normal);
    }
    if ((film.aovs & kAovDepth) != 0) {
        add_channel(film, pixel, channel_offset(film.aovs, kAovDepth),
                    dot(surface.position - ray.origin, picture.axis_at(pixel, time)));
    }
    if ((film.aovs & kAovDistance) != 0) {
        add_channel(film, pixel, channel_offset(film.aovs, kAovDistance), length(surface.position - ray.origin));
    }
    if ((film.aovs & kAovPosition) != 0) { // the film adds both without rounding
        const uint32_t channel = channel_offset(film.aovs, kAovPosition);
        add_channels(film, pixel, channel, surface.position);
        add_channels(film, pixel, channel, picture.scene.position_shift);
    }
    if ((film.aovs & kAovIds) != 0 && sample == 0) film.set_ids(pixel, {hit.instance, hit.primitive, surface.material});
}

} // namespace pertev
