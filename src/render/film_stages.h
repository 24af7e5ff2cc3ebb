#pragma once

// Operations on films other than adding samples: adding another film, and computing floats or displayed bytes from
// its sums. They run on the film's device, because a mean has a quarter of the size of its sum, and a displayed pixel
// a twelfth of the size of its colour sums. render/film.cpp launches them.

#include <cstdint>

#include "image/tone_map.h"
#include "render/film_view.h"
#include "trace/intersect/ray.h"

namespace pertev {

/// The stage that adds sums, with one call per sum.
struct AddSums {
    const FixedSum* from;
    FixedSum* to;

    HD void operator()(uint32_t i) const { to[i] = to[i] + from[i]; }
};

/// The stage that adds counts, with one call per count.
struct AddCounts {
    const uint64_t* from;
    uint64_t* to;

    HD void operator()(uint32_t i) const { to[i] += from[i]; }
};

/// The stage that copies values to elements that have none.
struct AddMissing {
    static constexpr uint32_t kMissing = 0xffffffffu; // bits

    const float* from;
    float* to;

    HD void operator()(uint32_t i) const {
        if (bits_of(to[i]) == kMissing) to[i] = from[i];
    }
};

/// The stage that adds the ids of each pixel. Ids belong to sample 0: a film without it holds kNoHit, as if nothing was
/// hit.
struct AddIds {
    const PixelIds* from;
    PixelIds* to;

    HD void operator()(uint32_t i) const {
        if (to[i].instance == kNoHit) to[i] = from[i];
    }
};

/// The stage that takes each pixel of `from` if `to` has had no sample there since it was cleared.
struct AddFrames {
    static constexpr uint32_t kNoSample = 0xffffffffu; // bits of w of the light

    const Float4* from;
    Float4* to;
    uint32_t pixels, arrays; // each of `arrays` holds all pixels; the light comes first

    HD void operator()(uint32_t i) const {
        if (bits_of(to[i].w) != kNoSample) return;
        for (uint32_t k = 0; k < arrays; ++k) to[uint64_t(k) * pixels + i] = from[uint64_t(k) * pixels + i];
    }
};

/// Consecutive channels of each pixel, whose means are computed together.
struct FilmMeans {
    uint32_t first, channels; // channels of the film
    bool over_hits;           // mean over samples that hit something, 0 if none did
    float* to = nullptr;      // [pixels * channels]
};

/// The stage that computes means of each pixel. Several in one launch read the sums of a pixel, which lie together,
/// once.
struct ResolveFilm {
    static constexpr uint32_t kHostGrain = 4096;
    static constexpr uint32_t kMost = 1 + film_channels::kGroups; // the picture and its layers

    FilmView film;
    uint64_t samples; // per pixel; 0: all means are 0
    FilmMeans means[kMost];
    uint32_t count;

    HD void operator()(uint32_t i) const {
        const FixedSum* sums = film.at_slot(FilmSlot{i});
        for (uint32_t k = 0; k < count; ++k) {
            const FilmMeans& of = means[k];
            const uint64_t n = of.over_hits ? sums[kFilmHits].high : samples; // each hit adds one, which is 2^64 units
            float* to = of.to + static_cast<uint64_t>(i) * of.channels;
            for (uint32_t c = 0; c < of.channels; ++c) to[c] = n == 0 ? 0.0f : mean_of(sums[of.first + c], n);
        }
    }
};

/// The stage that computes the bytes of each pixel for a display.
struct DisplayFilm {
    static constexpr uint32_t kHostGrain = 4096;

    FilmView film;
    uint64_t samples; // per pixel, > 0
    ToneMap kind;
    float scale;      // factor for the light before tone mapping
    bool keeps_alpha; // otherwise alpha is 255
    uint8_t* pixels;  // [pixels * 4]

    HD void operator()(uint32_t i) const {
        const FixedSum* sums = film.at_slot(FilmSlot{i});
        const Rgb light = {mean_of(sums[0], samples), mean_of(sums[1], samples), mean_of(sums[2], samples)};
        tone_map_pixel(light, keeps_alpha ? mean_of(sums[kFilmHits], samples) : 1.0f, kind, scale,
                       pixels + 4 * static_cast<uint64_t>(i));
    }
};

} // namespace pertev
