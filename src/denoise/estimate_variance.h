#pragma once

// Second stage of a single picture: mean of each signal, and the variance of that mean. A pixel's few samples do not
// determine the variance well, so it is pooled over surrounding pixels that show the same surface: around each
// pixel's own mean if there are enough samples, so that shadow edges do not count, else around the common mean.
//
// Source: Rousselle, Manzi, Zwicker, "Robust Denoising using Feature and Color Information", CGF 32(7), 2013, section 3
// (variance of samples, smoothed over pixels).

#include "denoise/picture_sums.h"

namespace pertev {

struct EstimateVariance {
    PictureGuide guide; // after smoothing
    PictureSums sums;
    SignalsView out;
    Vec2* of_sample; // variance of a sample of both signals, kUnknown or more if unknown; null: not wanted
    uint32_t width, height;
    bool has_gloss;

    // Factors of the variance: few bright samples contribute much of the light, and many pixels have none of them.
    // Highlights are narrower than a filter.
    static constexpr float kOfDiffuse = 1.5f, kOfGloss = 0.4f;
    static constexpr float kUnknown = 1e6f; // lets the filter average as much as guides allow

    /// Fraction of the spread of a pixel's samples that is noise: if its normals vary, its light does so too.
    HD static float noise_share(Float4 normals) {
        if (!(normals.w > 0)) return 1;
        const float spread = 1.0f - length(vec3_of(normals)) / normals.w; // 0.02: about ten degrees
        return square(max(1.0f - 10.0f * spread, 0.0f));
    }

    HD void operator()(uint32_t pixel) const {
        const uint32_t object = guide.object[pixel];
        out.diffuse[pixel] = out.gloss[pixel] = {0, 0, 0, 0};
        if (of_sample != nullptr) of_sample[pixel] = {0, 0};
        if (object == kNoHit) return;
        const int w = static_cast<int>(width), h = static_cast<int>(height);
        const int x = static_cast<int>(pixel % width), y = static_cast<int>(pixel / width);
        const Float4 here = guide.normal[pixel];
        Pool of_diffuse, of_gloss;
        for (int dy = -kReach; dy <= kReach; ++dy) {
            for (int dx = -kReach; dx <= kReach; ++dx) {
                if (x + dx < 0 || y + dy < 0 || x + dx >= w || y + dy >= h) continue;
                const uint32_t at = static_cast<uint32_t>((y + dy) * w + x + dx);
                const Float4 there = guide.normal[at];
                if (guide.object[at] != object || !(dot(vec3_of(there), vec3_of(here)) > 0.9f) ||
                    !(abs(there.w - here.w) <= 0.1f * here.w)) {
                    continue;
                }
                if (!(sums.diffuse[at].w > 0)) continue;
                if (const Sums there_is = diffuse_of(at); there_is.is_known()) of_diffuse.add(there_is);
                if (has_gloss) of_gloss.add(gloss_of(at));
            }
        }
        const float share = noise_share(sums.all_normal(pixel));
        out.diffuse[pixel] = of_diffuse.mean(diffuse_of(pixel), kOfDiffuse * share);
        if (has_gloss) out.gloss[pixel] = of_gloss.mean(gloss_of(pixel), kOfGloss * share);
        if (of_sample == nullptr) return;
        of_sample[pixel] = {of_diffuse.variance(diffuse_of(pixel)), has_gloss ? of_gloss.variance(gloss_of(pixel)) : 0};
    }

private:
    static constexpr int kReach = 2;       // pixels
    static constexpr float kFreedoms = 12; // degrees of freedom with which the variance of samples within pixels is
                                           // known
    /// Sums for one pixel and one signal.
    struct Sums {
        Rgb light, divisors;
        float signal, squares, samples; // luminances, their squares

        /// Squared deviations from the mean of the samples, at least 0.
        HD float spread() const { return max(squares - square(signal) / samples, 0.0f); }
        /// Returns whether there are samples of a surface that is not black.
        HD bool is_known() const {
            return samples > 0 && max(divisors.r, max(divisors.g, divisors.b)) >= kLeastKnown * samples;
        }
    };
    HD Sums diffuse_of(uint32_t at) const {
        const Float4 share = sums.diffuse_share[at];
        return {rgb_of(sums.diffuse[at]), rgb_of(share), share.w, sums.squares[at].x, sums.diffuse[at].w};
    }
    HD Sums gloss_of(uint32_t at) const {
        const Float4 share = sums.gloss_share[at];
        return {rgb_of(sums.gloss[at]), rgb_of(share), share.w, sums.squares[at].y, sums.diffuse[at].w};
    }

    /// Sums of one signal over pixels.
    struct Pool {
        Sums all = {{0, 0, 0}, {0, 0, 0}, 0, 0, 0};
        float within = 0, freedoms = 0; // spread within pixels
        float pixels = 0;

        HD void add(const Sums& one) {
            all.light += one.light;
            all.divisors += one.divisors;
            all.signal += one.signal;
            all.squares += one.squares;
            all.samples += one.samples;
            pixels += 1;
            if (!(one.samples > 1)) return;
            within += one.spread();
            freedoms += one.samples - 1;
        }
        HD float variance_of_sample() const {
            if (freedoms >= kFreedoms) return within / freedoms;
            return pixels >= 6 && all.samples > 1 ? all.spread() / (all.samples - 1) : kUnknown;
        }
        /// Variance of a sample of a pixel. If its own samples spread more than those of its neighbours, it is that,
        /// because otherwise a single bright one would remain.
        HD float variance(const Sums& own) const {
            const float of_all = variance_of_sample();
            return own.samples > 1 ? max(of_all, own.spread() / (own.samples - 1)) : of_all;
        }
        /// Mean and variance of a pixel. A pixel without samples on its guide's surface, or where that is black, takes
        /// the mean of its neighbours.
        HD Float4 mean(const Sums& own, float scale) const {
            const Sums& known = own.is_known() ? own : all;
            if (!known.is_known()) return {0, 0, 0, kUnknownSignal};
            const float inv = 1.0f / known.samples;
            const Rgb light = rgb_of(diffuse_signal(inv * known.light, inv * known.divisors));
            return with_w(light, (scale * variance(own)) / max(own.samples, 1.0f));
        }
    };
};

} // namespace pertev
