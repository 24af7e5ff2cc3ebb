#pragma once

// Variance and filter of what mirrors show: as denoise/estimate_variance.h and denoise/even_pass.h, but taps
// are compared where their chains end. Distances there are in the world, because a curved mirror has no virtual image
// of one depth.

#include "denoise/even_pass.h"
#include "denoise/mirror_sums.h"
#include "render/camera_view.h"

namespace pertev {

/// The stage that makes both signals, of reflection and of transmission, from the sums.
struct EstimateMirrorVariance {
    PictureGuide guide;
    PictureSums sums;
    MirrorSums mirrors;
    SignalsView out;
    uint32_t width, height;

    HD void operator()(uint32_t pixel) const {
        out.diffuse[pixel] = estimate(0, pixel);
        out.gloss[pixel] = estimate(1, pixel);
    }

private:
    static constexpr int kReach = 2;                      // pixels
    static constexpr float kFreedoms = 12, kScale = 1.5f; // EstimateVariance has kFreedoms and, for kScale, kOfDiffuse
    static constexpr float kUnknownVariance = 1e6f;

    HD Float4 estimate(int k, uint32_t pixel) const {
        constexpr Float4 kUnknown = {0, 0, 0, kUnknownSignal};
        const MirrorBranch& branch = mirrors.branches[k];
        const uint32_t turns = branch.turns(pixel), object = bits_of(branch.end[pixel].w);
        const float samples = sums.diffuse[pixel].w;
        if (turns < 2 || !(samples > 0)) return kUnknown;
        const int w = static_cast<int>(width), h = static_cast<int>(height);
        const int x = static_cast<int>(pixel % width), y = static_cast<int>(pixel / width);
        float within = 0, freedoms = 0, signal = 0, squares = 0, all = 0;
        for (int j = -kReach; j <= kReach; ++j) {
            for (int i = -kReach; i <= kReach; ++i) {
                if (x + i < 0 || y + j < 0 || x + i >= w || y + j >= h) continue;
                const uint32_t at = static_cast<uint32_t>((y + j) * w + x + i);
                const float count = sums.diffuse[at].w;
                if (branch.turns(at) != turns || bits_of(branch.end[at].w) != object || !(count > 0) ||
                    guide.object[at] != guide.object[pixel]) {
                    continue;
                }
                signal += branch.light[at].w;
                squares += squares_of(k, at);
                all += count;
                within += spread(k, at);
                freedoms += count - 1;
            }
        }
        const float inv = 1.0f / samples;
        const Float4 mean = diffuse_signal(inv * rgb_of(branch.light[pixel]), mirrors.color(k, pixel));
        if (mean.w < 0) return kUnknown;
        float variance = kUnknownVariance;
        if (freedoms >= kFreedoms) {
            variance = within / freedoms;
        } else if (all > 4) {
            variance = max(squares - square(signal) / all, 0.0f) / (all - 1);
        }
        if (samples > 1) variance = max(variance, spread(k, pixel) / (samples - 1));
        return with_w(rgb_of(mean), kScale * inv * variance);
    }
    HD float spread(int k, uint32_t at) const {
        const MirrorBranch& branch = mirrors.branches[k];
        return max(squares_of(k, at) - square(branch.light[at].w) / sums.diffuse[at].w, 0.0f);
    }
    HD float squares_of(int k, uint32_t at) const { return k == 0 ? mirrors.squares[at].x : mirrors.squares[at].y; }
};

/// A pass of the filter of both signals.
struct MirrorPass {
    PictureGuide guide;
    MirrorSums mirrors;
    SignalsView from, to;
    CameraView camera;
    uint32_t width, height;
    int step;        // pixels between taps
    float tolerance; // WaveletPass has the same

    HD void operator()(uint32_t pixel) const {
        to.diffuse[pixel] = filtered(mirrors.branches[0], from.diffuse, pixel);
        to.gloss[pixel] = filtered(mirrors.branches[1], from.gloss, pixel);
    }

private:
    static constexpr float kBend = 64; // WaveletPass bends diffuse light by it
    /// Steps of a pixel, as a straight view would have them, that a plane's points may be off: mirrors make pictures
    /// smaller.
    static constexpr float kPlane = 0.25f;

    HD Float4 filtered(const MirrorBranch& branch, const Float4* signal, uint32_t pixel) const {
        const Float4 own = signal[pixel], end = branch.end[pixel], normal = branch.normal[pixel];
        if (bits_of(normal.w) < 2 || bits_of(end.w) == kNoHit) return own;
        const int w = static_cast<int>(width), h = static_cast<int>(height);
        const int x = static_cast<int>(pixel % width), y = static_cast<int>(pixel / width);
        const float size = size_at(end);
        EvenSum sum(own, tolerance);
        for (int k = 0; k < 9; ++k) {
            const int column = x + (k % 3 - 1) * step, row = y + (k / 3 - 1) * step;
            if (k == 4 || column < 0 || row < 0 || column >= w || row >= h) continue;
            const int tap = row * w + column;
            const Float4 to_end = branch.end[tap], to_normal = branch.normal[tap];
            if (guide.object[tap] != guide.object[pixel] || bits_of(to_end.w) != bits_of(end.w) ||
                bits_of(to_normal.w) != bits_of(normal.w)) {
                continue;
            }
            const float bend = max(1.0f - fused_dot(vec3_of(to_normal), vec3_of(normal)), 0.0f);
            const Vec3 both = vec3_of(to_normal) + vec3_of(normal), apart = vec3_of(to_end) - vec3_of(end);
            const float off =
                kPlane * abs(fused_dot(both, apart)) / ((size + size_at(to_end)) * static_cast<float>(step));
            sum.add(signal[tap], tent_weight(k), fma(kBend, bend, off));
        }
        return sum.result();
    }
    /// Width of a pixel in a straight view of the chain's end.
    HD float size_at(Float4 end) const {
        return pixel_size(camera, length(vec3_of(end) - camera.world_from_camera.translation));
    }
};

/// Light that a pixel's guide shows by mirrors, from the filtered signals.
HD inline Rgb mirrored_light(const MirrorSums& mirrors, const SignalsView& signals, uint32_t pixel) {
    const float count = mirrors.is_there() ? mirrors.seen[pixel].w : 0.0f;
    if (!(count > 0)) return {0, 0, 0};
    const auto light = [&](const MirrorBranch& branch, const Float4* signal) {
        const auto times = [](Float4 color, Float4 there) {
            return there.w < 0 ? Rgb{0, 0, 0} : rgb_of(color) * rgb_of(there);
        };
        const Float4 edge = branch.edge[pixel];
        const Rgb own = times(branch.color[pixel], signal[pixel]);
        return bits_of(edge.w) == kNoHit ? own : own + times(edge, signal[bits_of(edge.w)]);
    };
    return (1.0f / count) * (rgb_of(mirrors.seen[pixel]) + light(mirrors.branches[0], signals.diffuse) +
                             light(mirrors.branches[1], signals.gloss));
}

} // namespace pertev
