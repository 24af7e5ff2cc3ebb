#pragma once

// A wavelet pass of a single picture that keeps its light: what a pixel gets of another is what it loses to that one.
// Otherwise a bright pixel, which varies much, takes from its dark neighbours while these, which vary little, refuse
// it, and the picture darkens. So both compare by one deviation, of their variances together, and by guides alike, and
// the weights are not divided by their sum.
//
// Sources: as for denoise/wavelet_pass.h. Weights that are equal both ways make the sum of the picture an invariant, as
// in anisotropic diffusion (Perona and Malik 1990, section III).

#include "denoise/reconstruction_view.h"

namespace pertev {

/// The new light of a pixel for one signal.
struct EvenSum {
    /// Differences are compared with `tolerance` deviations.
    HD EvenSum(Float4 own, float tolerance)
        : own_(own), light_{0, 0, 0}, centre_(fused_luminance(rgb_of(own))), tolerance_(square(tolerance)) {}

    /// Adds a tap. `kernel` is its weight relative to that of the centre, `difference` that of the guides.
    HD void add(Float4 tap, float kernel, float difference) {
        if (tap.w < 0) return;
        const bool is_known = !(own_.w < 0);
        const float unlike = abs(fused_luminance(rgb_of(tap)) - centre_),
                    deviation = safe_sqrt(0.5f * tolerance_ * (max(own_.w, 0.0f) + tap.w)) + 1e-4f;
        const float x = max(fma(-0.25f, difference + (is_known ? unlike / deviation : 0.0f), 1.0f), 0.0f);
        const float w = kAll * kernel * square(square(x));
        light_ = add_scaled(light_, w, rgb_of(tap));
        variance_ = fma(w * w, tap.w, variance_);
        weight_ += w;
    }
    HD Float4 result() const {
        if (own_.w < 0) { // unknown: takes the mean of the others
            if (!(weight_ > 0)) return {0, 0, 0, kUnknownSignal};
            const float inv = 1.0f / weight_;
            return with_w(inv * light_, inv * inv * variance_);
        }
        const float rest = 1.0f - weight_;
        return with_w(add_scaled(light_, rest, rgb_of(own_)), fma(rest * rest, own_.w, variance_));
    }

private:
    static constexpr float kAll = 0.25f; // 1 over the sum of the kernel

    Float4 own_;
    Rgb light_;
    float centre_, tolerance_, variance_ = 0, weight_ = 0;
};

/// Weight of tap k of three by three relative to that of the centre.
HD inline float tent_weight(int k) { return k % 2 == 1 ? 0.5f : 0.25f; }

struct EvenPass {
    const Float4* guide; // packed Guide
    SignalsView from, to;
    CameraView camera;
    uint32_t width, height;
    int step;        // pixels between taps
    float tolerance; // deviations of diffuse light; taps that differ by four times as much do not count
    bool has_gloss;

    HD void operator()(uint32_t pixel) const {
        const Float4 own = guide[pixel];
        if (object_of(own) == kNoHit) {
            to.diffuse[pixel] = from.diffuse[pixel];
            if (has_gloss) to.gloss[pixel] = from.gloss[pixel];
            return;
        }
        const int w = static_cast<int>(width), h = static_cast<int>(height);
        const int x = static_cast<int>(pixel % width), y = static_cast<int>(pixel / width);
        const Vec3 normal = normal_of(own), point = point_of(x, y, own);
        const float alpha = alpha_of(own), size = pixel_size(camera, depth_of(own));
        EvenSum of_diffuse(from.diffuse[pixel], tolerance);
        EvenSum of_gloss(has_gloss ? from.gloss[pixel] : Float4{0, 0, 0, 0}, kOfGloss);
        for (int k = 0; k < 9; ++k) {
            const int column = x + (k % 3 - 1) * step, row = y + (k / 3 - 1) * step;
            if (k == 4 || column < 0 || row < 0 || column >= w || row >= h) continue;
            const int tap = row * w + column;
            const Float4 there = guide[tap];
            if (object_of(there) != object_of(own)) continue;
            const Vec3 apart = point_of(column, row, there) - point, both = normal_of(there) + normal;
            const float bend = max(1.0f - fused_dot(normal_of(there), normal), 0.0f),
                        off = abs(fused_dot(transform_transposed(camera.world_from_camera, both), apart)) /
                              ((size + pixel_size(camera, depth_of(there))) * static_cast<float>(step));
            of_diffuse.add(from.diffuse[tap], tent_weight(k), fma(kBend, bend, off));
            const float narrowest = min(alpha, alpha_of(there));
            if (has_gloss && abs(alpha_of(there) - alpha) < 0.1f + 0.2f * narrowest) {
                // WaveletPass explains both.
                const float narrow = static_cast<float>(step) / (1.0f + square(64.0f * narrowest));
                of_gloss.add(from.gloss[tap], tent_weight(k),
                             fma(kBend + 8.0f / max(narrowest, 0.002f), bend, off) + narrow);
            }
        }
        to.diffuse[pixel] = of_diffuse.result();
        if (has_gloss) to.gloss[pixel] = of_gloss.result();
    }

private:
    static constexpr float kBend = 64, kOfGloss = 8; // WaveletPass has the same

    /// Position in camera space.
    HD Vec3 point_of(int x, int y, Float4 packed) const {
        return unproject_point(camera, {static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f}, depth_of(packed));
    }
};

} // namespace pertev
