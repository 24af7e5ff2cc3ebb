#pragma once

// The film's device view, to which samples are added. Channels of a pixel are contiguous, in the order of
// render/film_channels.h.

#include <cstdint>

#include "base/host_device.h"
#include "math/rgb.h"
#include "math/vec3.h"
#include "render/film_channels.h"
#include "render/fixed_sum.h"
#include "render/noisy_frame_view.h"
#include "render/pixel_window.h"

namespace pertev {

/// Ids of the first hit of a pixel's sample 0; kNoHit if it hit nothing or was not taken.
struct PixelIds {
    uint32_t instance, primitive, material;
};

struct FilmView {
    FixedSum* sums;    // [pixels * channels]
    PixelIds* ids;     // [pixels], or null
    uint64_t* invalid; // number of samples that were not finite or over kMaxSampleValue
    uint32_t channels;
    uint32_t aovs;        // AovBits
    PixelWindow window;   // the part of the picture that it covers
    NoisyFrameView frame; // if present, samples go to it, and there are no sums, ids or auxiliary channels; it covers
                          // the whole picture
    bool is_first;        // it has the film's first row, so what is counted once a film is counted here
    bool is_exclusive;    // on the host: no other thread adds to the pixels to which this view's user adds

    HD FixedSum* pixel(uint32_t number) const { return at_slot(window.slot_of(number)); }
    HD FixedSum* at_slot(FilmSlot slot) const { return sums + uint64_t(static_cast<uint32_t>(slot)) * channels; }
    HD void add(FixedSum* sum, FixedSum value) const {
#if !PERTEV_ON_DEVICE
        if (is_exclusive) { // an atomic addition takes some 20 cycles
            *sum = *sum + value;
            return;
        }
#endif
        atomic_add(sum, value);
    }
    HD void set_ids(uint32_t pixel, const PixelIds& of_pixel) const {
        ids[static_cast<uint32_t>(window.slot_of(pixel))] = of_pixel;
    }
};

HD inline bool is_valid_sample(float x) { return abs(x) <= kMaxSampleValue; } // false for NaN

/// Adds one sample's radiance to a pixel. A sample with an invalid channel adds 0 and is counted.
HD inline void add_radiance(const FilmView& film, uint32_t pixel, Rgb radiance) {
    if (!(is_valid_sample(radiance.r) && is_valid_sample(radiance.g) && is_valid_sample(radiance.b))) {
        atomic_add(film.invalid, 1);
        return;
    }
    FixedSum* sums = film.pixel(pixel);
    FixedSum red = to_fixed(radiance.r), green = to_fixed(radiance.g), blue = to_fixed(radiance.b);
#if PERTEV_ON_DEVICE
    if (!sum_of_warp(pixel, red, green, blue)) return; // another thread adds this one's sample
#endif
    film.add(&sums[0], red);
    film.add(&sums[1], green);
    film.add(&sums[2], blue);
}

/// Stores a pixel's sample in a frame: `radiance`, of which the first surface scatters `diffuse` by its diffuse
/// lobes. A sample with an invalid channel is stored as black and counted.
HD inline void store_sample(const FilmView& film, uint32_t pixel, Rgb radiance, Rgb diffuse) {
    const bool is_valid = is_valid_sample(radiance.r) && is_valid_sample(radiance.g) && is_valid_sample(radiance.b);
    if (!is_valid) atomic_add(film.invalid, 1);
    film.frame.light[pixel] = is_valid ? Float4{radiance.r, radiance.g, radiance.b, 1} : Float4{0, 0, 0, 0};
    if (film.frame.splits_light()) film.frame.diffuse[pixel] = {diffuse.r, diffuse.g, diffuse.b, 0};
}

/// Adds light to a frame's sample; arguments as in store_sample.
HD inline void add_to_sample(const FilmView& film, uint32_t pixel, Rgb radiance, Rgb diffuse) {
    const Float4 before = film.frame.light[pixel];
    if (before.w == 0) return; // invalid
    const bool splits_light = film.frame.splits_light();
    const Float4 d = splits_light ? film.frame.diffuse[pixel] : Float4{0, 0, 0, 0};
    store_sample(film, pixel, Rgb{before.x, before.y, before.z} + radiance, Rgb{d.x, d.y, d.z} + diffuse);
}

/// Adds a value to an auxiliary channel; an invalid value adds 0.
HD inline void add_channel(const FilmView& film, uint32_t pixel, uint32_t channel, float value) {
    if (is_valid_sample(value)) film.add(&film.pixel(pixel)[channel], to_fixed(value));
}

HD inline void add_channels(const FilmView& film, uint32_t pixel, uint32_t channel, Vec3 value) {
    add_channel(film, pixel, channel, value.x);
    add_channel(film, pixel, channel + 1, value.y);
    add_channel(film, pixel, channel + 2, value.z);
}

} // namespace pertev
