#pragma once

// What is done with a film beyond adding samples: adding another film, and making floats or bytes to be shown of its
// sums. On the film's own device, so that sums need not travel: a float is a quarter of one, a shown pixel a twelfth
// of those of its colour. Launched by render/film.cpp.

#include <cstdint>

#include "image/tone_map.h"
#include "render/film_view.h"
#include "trace/intersect/ray.h"

namespace pertev {

/// One sum each.
struct AddSums {
    const FixedSum* from;
    FixedSum* to;

    HD void operator()(uint32_t i) const { to[i] = to[i] + from[i]; }
};

/// One count each.
struct AddCounts {
    const uint64_t* from;
    uint64_t* to;

    HD void operator()(uint32_t i) const { to[i] += from[i]; }
};

/// One pixel each. Ids belong to sample 0: a film that has not got it holds kNoHit, as where it hit nothing.
struct AddIds {
    const PixelIds* from;
    PixelIds* to;

    HD void operator()(uint32_t i) const {
        if (to[i].instance == kNoHit) to[i] = from[i];
    }
};

/// Takes a pixel of `from` where `to` has had no sample since it was cleared.
struct AddFrames {
    static constexpr uint32_t kNoSample = 0xffffffffu; // bits of the light's w

    const Float4* from;
    Float4* to;
    uint32_t pixels, arrays; // each of `arrays` holds all pixels, that of the light first

    HD void operator()(uint32_t i) const {
        if (bits_of(to[i].w) != kNoSample) return;
        for (uint32_t k = 0; k < arrays; ++k) to[uint64_t(k) * pixels + i] = from[uint64_t(k) * pixels + i];
    }
};

/// Makes the means of some neighbouring channels of one pixel.
struct ResolveFilm {
    FilmView film;
    uint32_t first, channels; // of the film's
    bool over_hits;           // the mean over samples that hit something, 0 where none did
    uint64_t samples;         // of each pixel; 0: all means are 0
    float* pixels;            // [pixels * channels]

    HD void operator()(uint32_t i) const {
        const FixedSum* sums = film.at_place(i);
        const uint64_t count = over_hits ? sums[kFilmHits].high : samples; // ones are 2^64 units
        float* to = pixels + static_cast<uint64_t>(i) * channels;
        for (uint32_t c = 0; c < channels; ++c) to[c] = count == 0 ? 0.0f : mean_of(sums[first + c], count);
    }
};

/// What a display shows, one pixel each.
struct DisplayFilm {
    FilmView film;
    uint64_t samples; // of each pixel, > 0
    ToneMap kind;
    float scale;      // of light, before it is tone-mapped
    bool keeps_alpha; // else 255
    uint8_t* pixels;  // [pixels * 4]

    HD void operator()(uint32_t i) const {
        const FixedSum* sums = film.at_place(i);
        const Rgb light = {mean_of(sums[0], samples), mean_of(sums[1], samples), mean_of(sums[2], samples)};
        tone_map_pixel(light, keeps_alpha ? mean_of(sums[kFilmHits], samples) : 1.0f, kind, scale,
                       pixels + 4 * static_cast<uint64_t>(i));
    }
};

} // namespace pertev
