#pragma once

// Third stage: history clamping. Long means are clamped to what recent frames show, and the variance of the result is
// estimated: over time, or over neighbours if few frames have seen the surface point.
//
// Sources: Schied et al. 2017 (reconstruction.h), section 4.2; NVIDIA, GDC 2020 (accumulate_signals.h).

#include "denoise/reconstruction_view.h"
#include "render/row_band.h"

namespace pertev {

struct ClampHistory {
    HistoryView now; // the clamped means are stored here again
    SignalsView out; // means with their variance
    uint32_t width, height;
    bool limits;
    bool has_gloss;    // see AccumulateSignals
    RowBand band = {}; // the rows to be made
    static constexpr float kFewFrames = 4;
    static constexpr uint32_t kReach = 2; // rows beside a pixel's that it reads
    /// Factor on deviations. If few samples contribute most of the light, most pixels do not have enough of them to
    /// know their variance.
    static constexpr float kTails = 4;
    static constexpr float kUnknown = 1e6f; // lets the filter average as much as guides allow

    HD void operator()(uint32_t i) const {
        const PixelPosition at = tiled_in_band(i, width, band);
        const uint32_t pixel = at.y * width + at.x;
        const Float4 guide = now.guide[pixel];
        if (object_of(guide) == kNoHit) {
            out.diffuse[pixel] = {0, 0, 0, 0};
            if (has_gloss) out.gloss[pixel] = {0, 0, 0, 0};
            return;
        }
        Float4 diffuse = now.diffuse[pixel];
        const Vec2 squares = now.squares[pixel];
        const Neighbours around = neighbourhood(at, guide);
        if (limits) {
            diffuse = limit(diffuse, around, deviation_of_frames(squares.x, diffuse));
            now.diffuse[pixel] = diffuse;
        }
        out.diffuse[pixel] =
            with_w(rgb_of(diffuse), diffuse.w > 0 ? variance(squares.x, diffuse, around.variance) : kUnknownSignal);
        if (!has_gloss) return;
        Float4 gloss = now.gloss[pixel];
        if (limits) {
            gloss = limit_gloss(gloss, around, deviation_of_frames(squares.y, gloss));
            now.gloss[pixel] = gloss;
        }
        out.gloss[pixel] = with_w(
            rgb_of(gloss), variance(squares.y, gloss, around.is_known ? square(around.gloss_deviation) : kUnknown));
    }

private:
    /// Recent means of the surrounding pixels that show the same object.
    struct Neighbours {
        Rgb mean, deviation;
        float gloss_mean, gloss_deviation;
        float variance; // variance of the luminance; kUnknown if too few pixels are similar
        bool is_known;  // whether enough pixels are similar
    };

    /// Thirteen of the surrounding 25 pixels in a chessboard pattern, which give as much information at half of the
    /// cost.
    HD Neighbours neighbourhood(PixelPosition at, Float4 guide) const {
        const int w = static_cast<int>(width), h = static_cast<int>(height);
        int columns[5], rows[5];
        for (int k = 0; k < 5; ++k) {
            columns[k] = held(static_cast<int>(at.x), k - 2, w);
            rows[k] = held(static_cast<int>(at.y), k - 2, h) * w;
        }
        const Vec3 normal = normal_of(guide);
        const uint32_t object = object_of(guide);
        Rgb sum = {0, 0, 0}, squares = {0, 0, 0};
        float gloss = 0, gloss_squares = 0, gloss_count = 0, light = 0, light_squares = 0, count = 0;
        for (int k = 0; k < 25; k += 2) {
            const int tap = rows[k / 5] + columns[k % 5];
            const Float4 there = now.guide[tap];
            if (object_of(there) != object || !(fused_dot(normal_of(there), normal) > 0.9f)) continue;
            const Float4 recent = now.recent[tap];
            gloss += recent.w;
            gloss_squares = fma(recent.w, recent.w, gloss_squares);
            gloss_count += 1;
            const Rgb c = rgb_of(recent);
            if (c.r < 0) continue; // unknown
            sum += c;
            squares = {fma(c.r, c.r, squares.r), fma(c.g, c.g, squares.g), fma(c.b, c.b, squares.b)};
            const float l = fused_luminance(c);
            light += l;
            light_squares = fma(l, l, light_squares);
            count += 1;
        }
        const float inv = 1.0f / max(count, 1.0f), inv_gloss = 1.0f / max(gloss_count, 1.0f);
        Neighbours n;
        n.mean = inv * sum;
        const Rgb spread = inv * squares - n.mean * n.mean;
        n.deviation = {safe_sqrt(spread.r), safe_sqrt(spread.g), safe_sqrt(spread.b)};
        n.gloss_mean = inv_gloss * gloss;
        n.gloss_deviation = safe_sqrt(inv_gloss * gloss_squares - n.gloss_mean * n.gloss_mean);
        n.is_known = gloss_count >= 4;
        n.variance = count < 4 ? kUnknown : max(inv * light_squares - square(inv * light), 0.0f);
        return n;
    }

    /// Standard deviation of single frames' luminance around their mean.
    HD static float deviation_of_frames(float square_mean, Float4 mean) {
        return safe_sqrt(square_mean - square(fused_luminance(rgb_of(mean))));
    }
    /// Clamps `x` to the neighbourhood of the mean of recent frames. That is noisy too: over some twenty pixels by a
    /// tenth of a single frame's deviation. Five times that is allowed, because otherwise light from few bright samples
    /// would be lost wherever the last frames had none.
    HD static float within(float x, float mean, float deviation, float of_frames) {
        const float most = 2.0f * deviation + 0.5f * of_frames;
        return clamp(x, mean - most, mean + most);
    }
    HD Float4 limit(Float4 mean, const Neighbours& around, float of_frames) const {
        if (!(mean.w > kFewFrames)) return mean;
        return {within(mean.x, around.mean.r, around.deviation.r, of_frames),
                within(mean.y, around.mean.g, around.deviation.g, of_frames),
                within(mean.z, around.mean.b, around.deviation.b, of_frames), mean.w};
    }
    HD Float4 limit_gloss(Float4 mean, const Neighbours& around, float of_frames) const {
        if (!(mean.w > kFewFrames)) return mean;
        const float light = fused_luminance(rgb_of(mean)),
                    held = within(light, around.gloss_mean, around.gloss_deviation, of_frames);
        if (held == light) return mean;
        return light > 0 ? with_w((held / light) * rgb_of(mean), mean.w) : with_w(grey(max(held, 0.0f)), mean.w);
    }
    /// Variance of a mean over mean.w frames. A few frames do not determine their own spread.
    HD float variance(float square_mean, Float4 mean, float over_neighbours) const {
        if (mean.w < kFewFrames) return over_neighbours * (kFewFrames / max(mean.w, 1.0f));
        return kTails * max(square_mean - square(fused_luminance(rgb_of(mean))), 0.0f) / mean.w;
    }
};

} // namespace pertev
