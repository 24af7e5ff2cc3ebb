#pragma once

// Stages that compute temporal gradients of light (temporal_gradients_view.h): they compare the two small pictures and
// then repeatedly average neighbours at doubling distances, because a single sample per pixel is too noisy.

#include "denoise/split_light.h"
#include "denoise/temporal_gradients_view.h"
#include "render/tiled_pixel.h"

namespace pertev {

/// The stage that compares the light of both pictures where they show the same surface; elsewhere the gradient is
/// unknown. `after` has contacts (contacts.h). The guide has the changed share of the pixel's light in place of a
/// lobe's width.
struct CompareLight {
    NoisyFrameView before, after; // scene as it was, and as it is
    Float4 *guide, *was, *is;

    HD void operator()(uint32_t i) const {
        const Float4 normal = after.normal[i], normal_before = before.normal[i];
        const uint32_t object = bits_of(after.hit[i].x);
        const bool is_same = object != kNoHit && bits_of(before.hit[i].x) == object &&
                             is_similar_surface(normal_before, normal.w, vec3_of(normal));
        const Float4 then = signals_of(before, i), now = signals_of(after, i);
        was[i] = then;
        is[i] = now;
        guide[i] = pack({vec3_of(normal), changed_share(light_of(then), light_of(now)), normal.w,
                         is_same ? object_with(object, contact_of(after, i)) : kNoHit});
    }

private:
    HD static float light_of(Float4 signals) { return fused_luminance(rgb_of(signals)) + signals.w; }
    HD static Float4 signals_of(const NoisyFrameView& frame, uint32_t i) {
        const SplitLight light = split_light(frame, i);
        const float gloss = frame.splits_light() ? fused_luminance(light.gloss / light.gloss_divisor) : 0.0f;
        return with_w(rgb_of(diffuse_signal(light.diffuse, light.diffuse_divisor)), gloss);
    }
};

struct SpreadLight {
    const Float4 *guide, *was, *is;
    Float4 *was_out, *is_out;
    uint32_t width, height;
    int step; // pixels between taps

    HD void operator()(uint32_t i) const {
        const PixelPosition at = tiled_position(i, width, height);
        const uint32_t pixel = at.y * width + at.x;
        const Float4 own = guide[pixel];
        if (object_of(own) == kNoHit) {
            was_out[pixel] = is_out[pixel] = {0, 0, 0, 0};
            return;
        }
        const Vec3 normal = normal_of(own);
        const float depth = depth_of(own);
        const int w = static_cast<int>(width), h = static_cast<int>(height);
        Float4 sum_was = {0, 0, 0, 0}, sum_is = {0, 0, 0, 0};
        float sum = 0;
        for (int k = 0; k < 9; ++k) {
            const int dx = k % 3 - 1, dy = k / 3 - 1;
            const int x = static_cast<int>(at.x) + dx * step, y = static_cast<int>(at.y) + dy * step;
            if (x < 0 || y < 0 || x >= w || y >= h) continue;
            const int tap = y * w + x;
            const Float4 there = guide[tap];
            if (object_of(there) != object_of(own) || !(fused_dot(normal_of(there), normal) > 0.9f) ||
                !(abs(depth_of(there) - depth) <= 0.1f * static_cast<float>(step) * depth)) {
                continue;
            }
            const float weight = (dx == 0 ? 1.0f : 0.5f) * (dy == 0 ? 1.0f : 0.5f);
            sum_was = plus_scaled(sum_was, weight, was[tap]);
            sum_is = plus_scaled(sum_is, weight, is[tap]);
            sum += weight;
        }
        const float inv = 1.0f / sum;
        was_out[pixel] = plus_scaled({0, 0, 0, 0}, inv, sum_was);
        is_out[pixel] = plus_scaled({0, 0, 0, 0}, inv, sum_is);
    }

private:
    HD static Float4 plus_scaled(Float4 a, float scale, Float4 b) {
        return {fma(scale, b.x, a.x), fma(scale, b.y, a.y), fma(scale, b.z, a.z), fma(scale, b.w, a.w)};
    }
};

/// The stage that finds the largest changed share of the light of each pixel and its eight neighbours. It is not
/// averaged, because shadows of moving objects have sharp edges.
struct FindChangedShare {
    const Float4* guide; // guide of CompareLight
    float* share;
    uint32_t width, height;

    HD void operator()(uint32_t i) const {
        const int w = static_cast<int>(width), h = static_cast<int>(height);
        const int x = static_cast<int>(i % width), y = static_cast<int>(i / width);
        float largest = 0;
        for (int k = 0; k < 9; ++k) {
            const Float4 there = guide[held(y, k / 3 - 1, h) * w + held(x, k % 3 - 1, w)];
            if (object_of(there) != kNoHit) largest = max(largest, alpha_of(there));
        }
        share[i] = largest;
    }
};

} // namespace pertev
