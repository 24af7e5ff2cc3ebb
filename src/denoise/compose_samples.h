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
    float features;       // camera rays of each pixel
    bool has_gloss;       // false: that signal is black everywhere
    Float4* picture;      // rgb, W/(sr m2); w is unused

    HD void operator()(uint32_t pixel) const {
        const Float4 met = sums.met[pixel], loose = sums.loose[pixel];
        Rgb light = rgb_of(met) + rgb_of(sums.diffuse_color[pixel]) * rgb_of(signals.diffuse[pixel]);
        if (has_gloss) light += rgb_of(sums.gloss_color[pixel]) * rgb_of(signals.gloss[pixel]);
        light += sums.normal[pixel].w * mirrored_light(mirrors, mirrored, pixel);
        Rgb of_neighbours = {0, 0, 0};
        float neighbour_features = 0;
        for (int slot = 0; slot < kNeighbourSurfaces; ++slot) {
            const Float4 diffuse = sums.neighbour_diffuse[slot][pixel];
            const uint32_t neighbour = bits_of(diffuse.w);
            if (neighbour == kNoHit) break;
            const Float4 gloss = sums.neighbour_gloss[slot][pixel];
            of_neighbours += rgb_of(diffuse) * rgb_of(signals.diffuse[neighbour]);
            if (has_gloss) of_neighbours += rgb_of(gloss) * rgb_of(signals.gloss[neighbour]);
            of_neighbours += gloss.w * mirrored_light(mirrors, mirrored, neighbour);
            neighbour_features += gloss.w;
        }
        // The more samples of such surfaces the pixel has, the more they count.
        if (const Float4 own = sums.neighbour[pixel]; own.w > 0) {
            of_neighbours = lerp(of_neighbours, (neighbour_features / own.w) * rgb_of(own), own.w / (own.w + kTrusted));
        }
        light += of_neighbours;
        // Samples that fit no guide are used unfiltered. If only rays without light have hit such surfaces, the rest
        // represents them.
        const float loose_features = met.w;
        if (loose.w > 0) {
            light += (loose_features / loose.w) * rgb_of(loose);
        } else if (loose_features < features) {
            light = (features / (features - loose_features)) * light;
        }
        picture[pixel] = with_w((1.0f / features) * light, 0);
    }

private:
    static constexpr float kTrusted = 8; // number of samples that count as much as the neighbouring pixel
};

} // namespace pertev
