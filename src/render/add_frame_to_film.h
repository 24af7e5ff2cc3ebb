#pragma once

// Adds the samples of a noisy frame to a film. The sums equal, to the bit, those of a path tracer that adds to the
// film directly.

#include "device_scene/surface.h"
#include "render/film_view.h"

namespace pertev {

struct AddFrameToFilm {
    NoisyFrameView frame;
    FilmView film;
    SceneView scene;
    bool is_first; // sample 0, which writes the ids

    HD void operator()(uint32_t pixel) const {
        const Float4 light = frame.light[pixel], stored = frame.hit[pixel];
        if (light.w != 0) add_radiance(film, pixel, {light.x, light.y, light.z});
        const Hit hit = {
            .t = 0, .u = stored.z, .v = stored.w, .instance = bits_of(stored.x), .primitive = bits_of(stored.y)};
        const bool is_background = shows_background(scene, hit.instance);
        if (!is_background) add_hit(pixel, hit);
        if ((film.aovs & kAovIds) != 0 && is_first) {
            film.set_ids(pixel, is_background
                                    ? PixelIds{kNoHit, kNoHit, kNoHit}
                                    : PixelIds{hit.instance, hit.primitive, scene.instances[hit.instance].material});
        }
    }

private:
    /// Adds auxiliary channels as add_first_hit does (render/first_hit.h).
    HD void add_hit(uint32_t pixel, const Hit& hit) const {
        const Float4 normal = frame.normal[pixel], albedo = frame.albedo[pixel];
        add_channel(film, pixel, kFilmHits, 1.0f);
        if ((film.aovs & kAovAlbedo) != 0) {
            add_channels(film, pixel, channel_offset(film.aovs, kAovAlbedo), {albedo.x, albedo.y, albedo.z});
        }
        if ((film.aovs & kAovNormal) != 0) {
            add_channels(film, pixel, channel_offset(film.aovs, kAovNormal), {normal.x, normal.y, normal.z});
        }
        if ((film.aovs & kAovDepth) != 0) {
            add_channel(film, pixel, channel_offset(film.aovs, kAovDepth), normal.w);
        }
        if ((film.aovs & kAovPosition) != 0) { // a frame stores the hit, not its position
            const InstanceView& instance = scene.instances[hit.instance];
            const uint32_t channel = channel_offset(film.aovs, kAovPosition);
            add_channels(film, pixel, channel, world_triangle(instance, scene.meshes[instance.mesh], hit).position);
            add_channels(film, pixel, channel, scene.position_shift);
        }
    }
};

} // namespace pertev
