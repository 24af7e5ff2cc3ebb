#pragma once

// Stages that mix the samples of a denoised picture with those of the frames before it (denoise/picture_history.h).
// They stand between the sums over samples and the filter: means and variances are those of all frames' samples, so the
// filter blurs less.
//
// A history is biased where light has changed. Means of its difference from the present samples over two windows show
// the bias as far as their noise lets them. It then counts as so many samples that the filtered light has the least
// mean square error: with N samples of variance s2 and a bias d as 1 / (1 / N + gain d2 / s2), where `gain` is by how
// much the filter lowers variance. Light is weighted by the inverse of its mean square error.
//
// Source of the reprojection: Schied et al., "Spatiotemporal Variance-Guided Filtering", HPG 2017, section 4.1.

#include "denoise/estimate_variance.h"
#include "denoise/picture_history.h"
#include "denoise/reproject.h"

namespace pertev {

/// The stage that takes the light of the frame before to the pixels of the present one.
struct ReprojectHistory {
    GBufferView centres; // the hits of rays through pixels' centres
    PictureGuide guide;
    SceneView scene;
    PreviousScene scene_before;
    FrameCameras cameras;
    HistoryView before; // variances are its `squares`
    PictureHistoryView to;
    float samples; // per pixel and frame
    bool has_gloss;

    HD void operator()(uint32_t pixel) const {
        to.diffuse[pixel] = to.gloss[pixel] = {0, 0, 0, 0};
        to.variances[pixel] = {0, 0};
        const uint32_t object = guide.object[pixel];
        if (object == kNoHit) return;
        const Vec2 centre = {static_cast<float>(pixel % cameras.width) + 0.5f,
                             static_cast<float>(pixel / cameras.width) + 0.5f};
        const Float4 hit = centres.hit[pixel];
        const Reprojection then = reproject_surface(cameras, scene, scene_before, centre, hit);
        const Taps taps = find_taps(before, cameras, then.pixel, max(then.depth, 1e-20f), vec3_of(guide.normal[pixel]),
                                    kMinNormalCosine, object);
        const auto known = [&](const Float4* values) { return taps_of_known(taps, cameras, values); };
        if (const Taps of_diffuse = known(before.diffuse); of_diffuse.sum > kEnoughWeight) {
            to.diffuse[pixel] = mean_of_taps(of_diffuse, cameras, before.diffuse);
            to.variances[pixel].x = variance_of_taps(of_diffuse, false);
        }
        if (!has_gloss) return;
        if (const Taps of_gloss = known(before.gloss); of_gloss.sum > kEnoughWeight) {
            Float4 gloss = mean_of_taps(of_gloss, cameras, before.gloss);
            const float frames = frames_of_lobe(cameras, scene, abs(guide.albedo[pixel].w), hit);
            gloss.w = min(gloss.w, samples * max(frames - 1.0f, 0.0f)); // one of the frames is the present one
            to.gloss[pixel] = gloss;
            to.variances[pixel].y = variance_of_taps(of_gloss, true);
        }
    }

private:
    /// Mean over the taps that know their variance, EstimateVariance::kUnknown if none does.
    HD float variance_of_taps(const Taps& taps, bool of_gloss) const {
        float sum = 0, weight = 0;
        for (int k = 0; k < 4; ++k) {
            if (!(taps.weights[k] > 0)) continue;
            const Vec2 both = before.squares[tap_pixel(taps, cameras, k)];
            const float variance = of_gloss ? both.y : both.x;
            if (!(variance < EstimateVariance::kUnknown)) continue;
            sum = fma(taps.weights[k], variance, sum);
            weight += taps.weights[k];
        }
        return weight > 0 ? sum / weight : EstimateVariance::kUnknown;
    }
};

/// Data that the stages of the mix share.
struct HistoryMix {
    PictureSums sums;
    SignalsView signals;        // present
    const Vec2* of_sample;      // variance of a sample of both (EstimateVariance)
    PictureHistoryView history; // reprojected
    float most;                 // samples that a history may count as
    bool has_gloss;

    HD float own_samples(uint32_t pixel) const { return sums.diffuse[pixel].w; }
    HD static bool is_known(float variance) { return variance < EstimateVariance::kUnknown; }
};

/// The stage that compares each pixel's light with its history: the differences of luminance of diffuse light and of
/// gloss, each with its variance, which is kUnknownSignal where one is unknown.
struct CompareHistory {
    HistoryMix mix;
    Float4* to;

    HD void operator()(uint32_t pixel) const {
        const float own = mix.own_samples(pixel);
        const Vec2 now = mix.of_sample[pixel], then = mix.history.variances[pixel];
        const Vec2 diffuse = difference(mix.signals.diffuse[pixel], mix.history.diffuse[pixel], own, now.x, then.x);
        Vec2 gloss = {0, kUnknownSignal};
        if (mix.has_gloss) gloss = difference(mix.signals.gloss[pixel], mix.history.gloss[pixel], own, now.y, then.y);
        to[pixel] = {diffuse.x, diffuse.y, gloss.x, gloss.y};
    }

private:
    HD Vec2 difference(Float4 now, Float4 then, float own, float of_now, float of_then) const {
        if (now.w < 0 || !(own > 0) || !(then.w > 0) || !HistoryMix::is_known(max(of_now, of_then)))
            return {0, kUnknownSignal};
        // The history has seen more samples. Few present ones without a bright one would seem surprising.
        const float variance = max(of_now, of_then);
        return {fused_luminance(rgb_of(now)) - fused_luminance(rgb_of(then)),
                variance / own + variance / min(then.w, mix.most)};
    }
};

/// The stage that averages differences over (2 reach + 1) times as many pixels, `step` apart.
struct AverageDifference {
    const Float4* guide; // packed Guide
    const Float4* from;
    Float4* to;
    uint32_t width, height;
    int reach, step; // taps to each side, and pixels between them

    HD void operator()(uint32_t pixel) const {
        const Float4 own = guide[pixel];
        const uint32_t object = object_of(own);
        if (object == kNoHit) {
            to[pixel] = {0, kUnknownSignal, 0, kUnknownSignal};
            return;
        }
        const int w = static_cast<int>(width), h = static_cast<int>(height);
        const int x = static_cast<int>(pixel % width), y = static_cast<int>(pixel / width);
        const Vec3 normal = normal_of(own);
        Sum diffuse, gloss;
        for (int dy = -reach; dy <= reach; ++dy) {
            for (int dx = -reach; dx <= reach; ++dx) {
                const int column = x + dx * step, row = y + dy * step;
                if (column < 0 || row < 0 || column >= w || row >= h) continue;
                const int tap = row * w + column;
                const Float4 there = guide[tap];
                if (object_of(there) != object || !(fused_dot(normal_of(there), normal) > 0.9f)) continue;
                const Float4 difference = from[tap];
                diffuse.add(difference.x, difference.y);
                gloss.add(difference.z, difference.w);
            }
        }
        const Vec2 of_diffuse = diffuse.mean(), of_gloss = gloss.mean();
        to[pixel] = {of_diffuse.x, of_diffuse.y, of_gloss.x, of_gloss.y};
    }

private:
    struct Sum {
        float all = 0, variance = 0, count = 0;

        HD void add(float difference, float of_difference) {
            if (of_difference < 0) return;
            all += difference;
            variance += of_difference;
            count += 1;
        }
        HD Vec2 mean() const {
            if (!(count > 0)) return {0, kUnknownSignal};
            const float inv = 1.0f / count;
            return {inv * all, square(inv) * variance};
        }
    };
};

/// The stage that mixes the light of a picture's samples with its history, and stores the result as the next one.
struct MixHistory {
    HistoryMix mix;           // its signals are replaced
    const Float4 *near, *far; // mean differences
    const Float4* guide;      // packed Guide
    HistoryView next;         // variances are its `squares`

    HD void operator()(uint32_t pixel) const {
        const float share = EstimateVariance::noise_share(mix.sums.all_normal(pixel));
        const Vec2 now = mix.of_sample[pixel], then = mix.history.variances[pixel];
        const Float4 here = near[pixel], around = far[pixel];
        Vec2 variances = {0, 0};
        next.guide[pixel] = guide[pixel];
        next.diffuse[pixel] = mixed(
            pixel, mix.signals.diffuse[pixel], mix.history.diffuse[pixel],
            {now.x, then.x, max(bias(here.x, here.y), bias(around.x, around.y)), EstimateVariance::kOfDiffuse * share},
            variances.x);
        if (mix.has_gloss) {
            next.gloss[pixel] = mixed(pixel, mix.signals.gloss[pixel], mix.history.gloss[pixel],
                                      {now.y, then.y, max(bias(here.z, here.w), bias(around.z, around.w)),
                                       EstimateVariance::kOfGloss * share},
                                      variances.y);
        }
        next.squares[pixel] = variances;
    }

private:
    static constexpr float kGain = 400;     // by how much the filter lowers variance
    static constexpr float kSurprising = 3; // squared differences of fewer variances are noise

    /// Square of the bias that a difference shows.
    HD static float bias(float difference, float variance) {
        return variance < 0 ? 0.0f : max(square(difference) - kSurprising * variance, 0.0f);
    }
    struct Spread {
        float of_now, of_then; // variances of a sample
        float bias;            // square
        float scale;           // factor of variances for the filter
    };
    /// Replaces a present signal by its mean with the history `then`, and returns this for the next frame.
    HD Float4 mixed(uint32_t pixel, Float4& now, Float4 then, Spread spread, float& variance) const {
        if (now.w < 0) return {0, 0, 0, 0};
        const float own = mix.own_samples(pixel);
        variance = spread.of_now;
        // A pixel without samples of its own has the light of others.
        if (!(then.w > 0)) return with_w(rgb_of(now), own);
        const float present = HistoryMix::is_known(spread.of_now) ? spread.of_now : spread.of_then;
        const float of_bias = kGain * spread.bias / max(present, 1e-20f);
        const float samples = max(1.0f / (1.0f / min(then.w, mix.most) + of_bias), 1e-6f);
        const float all = own + samples, share = own / all;
        if (!HistoryMix::is_known(spread.of_now)) {
            variance = spread.of_then;
        } else if (HistoryMix::is_known(spread.of_then)) {
            variance = lerp(spread.of_then, spread.of_now, share);
        }
        now = with_w(lerp(rgb_of(then), rgb_of(now), share), spread.scale * variance / all);
        return with_w(rgb_of(now), all);
    }
};

} // namespace pertev
