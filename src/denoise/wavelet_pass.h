#pragma once

// Fourth stage, some times over: a mean over neighbours at doubling distances, which follows what the guides show
// (plane, normal, object) and stops where light differs by more than its own deviation explains.
//
// Sources: Dammertz et al., "Edge-Avoiding A-Trous Wavelet Transform for fast Global Illumination Filtering", HPG 2010;
// Schied et al. 2017, section 4.4 (variance in the weight of light, and filtered along).

#include "denoise/reconstruction_view.h"
#include "render/tiled_pixel.h"

namespace pertev {

struct WaveletPass {
    const Float4* normal; // HistoryView's, of the present frame
    const uint32_t* object;
    const Float4* albedo; // NoisyFrameView's
    SignalsView from, to;
    CameraView camera;
    uint32_t width, height;
    int step;       // pixels between taps
    bool has_gloss; // false: that signal is black everywhere

    HD void operator()(uint32_t i) const {
        const uint32_t pixel = tiled_pixel(i, width, height);
        const Float4 diffuse = from.diffuse[pixel], gloss = has_gloss ? from.gloss[pixel] : Float4{0, 0, 0, 0};
        const uint32_t own = object[pixel];
        if (own == kNoHit) {
            to.diffuse[pixel] = diffuse;
            if (has_gloss) to.gloss[pixel] = gloss;
            return;
        }
        const int w = static_cast<int>(width), h = static_cast<int>(height);
        const int x = static_cast<int>(pixel % width), y = static_cast<int>(pixel / width);
        const Float4 here = normal[pixel];
        const Vec3 n = vec3_of(here);
        const Plane plane(camera, n, here.w, x, y, step);
        const float alpha = albedo[pixel].w;
        // What bends reflections away, and what tells them from their neighbours by themselves.
        const float bend_of_gloss = 64.0f + 8.0f / max(alpha, 0.002f),
                    narrow = static_cast<float>(step) / (1.0f + square(64.0f * alpha));
        Sum of_diffuse(diffuse, deviation_of(from.diffuse, x, y));
        Sum of_gloss(gloss, has_gloss ? deviation_of(from.gloss, x, y) : 0.0f);
        for (int dy = -1; dy <= 1; ++dy) {
            for (int dx = -1; dx <= 1; ++dx) {
                const int px = x + dx * step, py = y + dy * step;
                if ((dx == 0 && dy == 0) || px < 0 || py < 0 || px >= w || py >= h) continue;
                const uint32_t tap = static_cast<uint32_t>(py * w + px);
                if (object[tap] != own) continue;
                const Float4 there = normal[tap];
                const float bend = max(1.0f - dot(vec3_of(there), n), 0.0f), off = plane.distance(px, py, there.w);
                const float kernel = weight_of(dx) * weight_of(dy);
                of_diffuse.add(from.diffuse[tap], kernel, off + 64.0f * bend);
                if (has_gloss && abs(albedo[tap].w - alpha) < 0.1f + 0.2f * alpha) {
                    of_gloss.add(from.gloss[tap], kernel, off + bend_of_gloss * bend + narrow);
                }
            }
        }
        to.diffuse[pixel] = of_diffuse.mean();
        if (has_gloss) to.gloss[pixel] = of_gloss.mean();
    }

private:
    /// exp(-x) for a fifth of its price: (1 - x / 4)^4, and 0 from 4 on.
    HD static float falloff(float x) { return square(square(max(1.0f - 0.25f * x, 0.0f))); }

    /// The plane of the surface at a pixel. Seen by the camera a point is linear in its pixel, times its depth in
    /// perspective.
    struct Plane {
        float at_zero, per_column, per_row, per_depth, here;
        bool is_perspective;

        HD Plane(const CameraView& camera, Vec3 normal, float depth, int x, int y, int step)
            : is_perspective(camera.projection == Projection::Perspective) {
            const Vec3 n = transform_transposed(camera.world_from_camera, normal);
            // Distances are counted in widths of a tap's step at this depth.
            const float size = 2.0f * camera.half_height * camera.inv_height * (is_perspective ? depth : 1.0f);
            const float scale = 1.0f / (size * static_cast<float>(step));
            per_column = scale * (n.x * (2.0f * camera.inv_width * camera.half_width));
            per_row = -scale * (n.y * (2.0f * camera.inv_height * camera.half_height));
            at_zero = 0.5f * (per_column + per_row) + scale * (n.y * camera.half_height - n.x * camera.half_width);
            per_depth = -scale * n.z;
            here = 0;
            here = signed_distance(x, y, depth);
        }
        HD float signed_distance(int x, int y, float depth) const {
            const float in_view = fma(per_column, static_cast<float>(x), fma(per_row, static_cast<float>(y), at_zero));
            return fma(is_perspective ? depth : 1.0f, in_view, per_depth * depth) - here;
        }
        HD float distance(int x, int y, float depth) const { return abs(signed_distance(x, y, depth)); }
    };

    /// Of one signal: values by their weights, variances by the squares of these.
    struct Sum {
        Rgb light;
        float variance, weight = 1, centre, inv_deviation;

        HD Sum(Float4 own, float deviation)
            : light(rgb_of(own)), variance(own.w), centre(luminance(rgb_of(own))),
              inv_deviation(1.0f / (4.0f * deviation + 1e-4f)) {}
        HD void add(Float4 tap, float kernel, float difference) {
            const float unlike = abs(luminance(rgb_of(tap)) - centre) * inv_deviation;
            const float w = kernel * falloff(difference + unlike);
            light += w * rgb_of(tap);
            variance += w * w * tap.w;
            weight += w;
        }
        HD Float4 mean() const {
            const float inv = 1.0f / weight;
            return with_w(inv * light, inv * inv * variance);
        }
    };

    /// Of nine taps' tent, over that of the centre. Measured: twenty-five taps of a B3 spline are no better by FLIP,
    /// and cost twice the time.
    HD static float weight_of(int offset) { return offset == 0 ? 1.0f : 0.5f; }
    /// Of light at a pixel: variances are noisy themselves, so that over its neighbours.
    HD float deviation_of(const Float4* signal, int x, int y) const {
        float sum = 0, weights = 0;
        for (int dy = -1; dy <= 1; ++dy) {
            for (int dx = -1; dx <= 1; ++dx) {
                const int px = x + dx, py = y + dy;
                if (px < 0 || py < 0 || px >= static_cast<int>(width) || py >= static_cast<int>(height)) continue;
                const float w = (dx == 0 ? 2.0f : 1.0f) * (dy == 0 ? 2.0f : 1.0f);
                sum += w * signal[py * static_cast<int>(width) + px].w;
                weights += w;
            }
        }
        return safe_sqrt(sum / weights);
    }
};

} // namespace pertev
