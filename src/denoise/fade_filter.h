#pragma once

// Stages by which the filter of a single picture fades as the noise of its samples does. Two parts of it are biased:
// light is averaged over a few deviations of its noise, which blurs edges of light, and edges and textures are composed
// of the colours of neighbours. With few samples noise is worse than both; with many the mean of the samples is right.
//
// - The tolerance for differences of light falls with the relative deviation, once that is small.
// - The filtered picture is mixed with the mean of the samples: weights are inverse to squared errors, with a relative
//   bias for the former.

#include "denoise/mirror_pass.h"

namespace pertev {

/// Sums the variance of the luminance of each pixel's mean, of which the signals have the parts, as the filter counts
/// it (EstimateVariance: not where normals vary). Light of samples that no guide shows is not filtered and does not
/// count.
struct GatherNoise {
    PictureSums sums;
    SignalsView signals; // neither filtered nor faded
    float first_features;
    bool has_gloss;
    float* noise;

    HD void operator()(uint32_t pixel) const {
        float sum = of_light(pixel, sums.all_diffuse_color(pixel), sums.all_gloss_color(pixel));
        for (int slot = 0; slot < kNeighbourSurfaces; ++slot) {
            const uint32_t neighbour = bits_of(sums.neighbour_diffuse[slot][pixel].w);
            if (neighbour == kNoHit) break;
            sum += of_light(neighbour, sums.all_neighbour_diffuse(slot, pixel),
                            rgb_of(sums.all_neighbour_gloss(slot, pixel)));
        }
        noise[pixel] = sum / square(sums.features(first_features, pixel));
    }

private:
    HD float of_light(uint32_t from, Rgb diffuse_color, Rgb gloss_color) const {
        float sum = square(luminance(diffuse_color)) * max(signals.diffuse[from].w, 0.0f);
        if (has_gloss) sum = fma(square(luminance(gloss_color)), max(signals.gloss[from].w, 0.0f), sum);
        return sum;
    }
};

/// Adds the variance of light that comes by mirrors.
struct GatherMirrorNoise {
    PictureSums sums;
    MirrorSums mirrors;
    SignalsView signals; // signals of mirrors, which are neither filtered nor faded
    float first_features;
    float* noise;

    HD void operator()(uint32_t pixel) const {
        float sum = of_mirrors(pixel, sums.all_normal(pixel).w);
        for (int slot = 0; slot < kNeighbourSurfaces; ++slot) {
            const uint32_t neighbour = bits_of(sums.neighbour_diffuse[slot][pixel].w);
            if (neighbour == kNoHit) break;
            sum += of_mirrors(neighbour, sums.all_neighbour_gloss(slot, pixel).w);
        }
        noise[pixel] += sum / square(sums.features(first_features, pixel));
    }

private:
    HD float of_mirrors(uint32_t from, float features) const {
        const Rgb reflected = features * mirrors.color(0, from), transmitted = features * mirrors.color(1, from);
        return fma(square(luminance(reflected)), max(signals.diffuse[from].w, 0.0f),
                   square(luminance(transmitted)) * max(signals.gloss[from].w, 0.0f));
    }
};

/// Lowers the variances by which filters compare light.
struct FadeSignals {
    SignalsView signals;
    bool has_gloss;

    HD void operator()(uint32_t pixel) const {
        fade(signals.diffuse[pixel]);
        if (has_gloss) fade(signals.gloss[pixel]);
    }

private:
    static constexpr float kFull = 0.5f; // least relative deviation with which all of the variance counts

    HD static void fade(Float4& light) {
        const float least = square(kFull * fused_luminance(rgb_of(light)));
        if (light.w > 0 && light.w < least) light.w *= light.w / least;
    }
};

/// Mixes filtered pixels with means of the samples. The first samples are left as they are: the colours of more rays
/// have been composed than the mean has.
struct MixMean {
    PictureSums sums;
    const Float4* mean;
    const float* noise; // variance of the mean's luminance
    Float4* picture;    // filtered

    HD void operator()(uint32_t pixel) const {
        if (sums.exact.at(SampleSums::kFeatures, pixel) == 0) return;
        const float of_filter = square(kBias * luminance(rgb_of(picture[pixel])));
        const float weight = of_filter / (of_filter + noise[pixel]);
        if (!(weight > 0)) return; // black, or not a number
        picture[pixel] = with_w(lerp(rgb_of(picture[pixel]), rgb_of(mean[pixel]), weight), 0);
    }

private:
    static constexpr float kBias = 0.06f; // relative to the light
};

} // namespace pertev
