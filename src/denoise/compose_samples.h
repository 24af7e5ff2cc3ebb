#pragma once

// Last stage of a single picture: multiplies the colours that samples hit by the light on them, from the pixel's own
// guide or from a neighbouring pixel.

#include "denoise/mirror_pass.h"

namespace pertev {

struct ComposeSamples {
    PictureSums sums;
    SignalsView signals;  // filtered
    MirrorSums mirrors;   // may be empty
    SignalsView mirrored; // filtered, of `mirrors`
    float first_features; // camera rays of each pixel in the sums of features of the first samples
    bool has_gloss;       // false: that signal is black everywhere
    Float4* picture;      // rgb, W/(sr m2); w is unused

    HD void operator()(uint32_t pixel) const {
        const float features = sums.features(first_features, pixel);
        const Float4 emission = sums.all_emission(pixel), loose = sums.loose(pixel);
        Rgb light = sums.all_diffuse_color(pixel) * rgb_of(signals.diffuse[pixel]);
        if (has_gloss) light += sums.all_gloss_color(pixel) * rgb_of(signals.gloss[pixel]);
        light += sums.all_normal(pixel).w * mirrored_light(mirrors, mirrored, pixel);
        Rgb of_neighbours = {0, 0, 0};
        float neighbour_features = 0;
        bool is_missing = false; // a neighbour, of a row without samples, has neither features nor light
        for (int slot = 0; slot < kNeighbourSurfaces; ++slot) {
            const uint32_t neighbour = bits_of(sums.neighbour_diffuse[slot][pixel].w);
            if (neighbour == kNoHit) break;
            is_missing = is_missing || !(sums.normal[neighbour].w >= 0);
            const Float4 gloss = sums.all_neighbour_gloss(slot, pixel);
            of_neighbours += sums.all_neighbour_diffuse(slot, pixel) * rgb_of(signals.diffuse[neighbour]);
            if (has_gloss) of_neighbours += rgb_of(gloss) * rgb_of(signals.gloss[neighbour]);
            of_neighbours += gloss.w * mirrored_light(mirrors, mirrored, neighbour);
            neighbour_features += gloss.w;
        }
        // The more samples of such surfaces the pixel has, the more they count.
        if (const Float4 own = sums.neighbour(pixel); own.w > 0) {
            const float trust = is_missing ? 1.0f : own.w / (own.w + kTrusted);
            of_neighbours = lerp(of_neighbours, (neighbour_features / own.w) * rgb_of(own), trust);
        }
        light += of_neighbours;
        // Scattered light of samples that fit no guide is used unfiltered. If only rays without light have hit such
        // surfaces, the rest represents them. Emission is known of all rays, so that no small emitter is lost.
        const float loose_features = emission.w;
        if (loose.w > 0) {
            light += (loose_features / loose.w) * rgb_of(loose);
        } else if (loose_features < features) {
            light = (features / (features - loose_features)) * light;
        }
        picture[pixel] = with_w((1.0f / features) * (light + rgb_of(emission)), 0);
    }

private:
    static constexpr float kTrusted = 8; // number of samples that count as much as the neighbouring pixel
};

} // namespace pertev
