#pragma once

// Fourth stage, some times over: a mean over neighbours at doubling distances, which follows what the guides show
// (plane, normal, object) and stops where light differs by more than its own deviation explains.
//
// Sources: Dammertz et al., "Edge-Avoiding A-Trous Wavelet Transform for fast Global Illumination Filtering", HPG 2010;
// Schied et al. 2017, section 4.4 (variance in the weight of light, and filtered along).

#include "denoise/reconstruction_view.h"
#include "math/portable_math.h"
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
            to.gloss[pixel] = gloss;
            return;
        }
        const int w = static_cast<int>(width), h = static_cast<int>(height);
        const int x = static_cast<int>(pixel % width), y = static_cast<int>(pixel / width);
        const Float4 here = normal[pixel];
        const Vec3 n = vec3_of(here), in_camera = transform_transposed(camera.world_from_camera, n);
        const Vec3 point = at(x, y, here.w);
        // A pixel's width there, metres: taps may lie off the plane by a part of it.
        const float size = 2.0f * camera.half_height * camera.inv_height *
                           (camera.projection == Projection::Perspective ? here.w : 1.0f);
        const float per_metre = 1.0f / (size * static_cast<float>(step));
        const float alpha = albedo[pixel].w;
        Sum of_diffuse(diffuse, deviation_of(from.diffuse, x, y)),
            of_gloss(gloss, has_gloss ? deviation_of(from.gloss, x, y) : 0);
        for (int dy = -2; dy <= 2; ++dy) {
            for (int dx = -2; dx <= 2; ++dx) {
                const int px = x + dx * step, py = y + dy * step;
                if ((dx == 0 && dy == 0) || px < 0 || py < 0 || px >= w || py >= h) continue;
                const uint32_t tap = static_cast<uint32_t>(py * w + px);
                if (object[tap] != own) continue;
                const Float4 there = normal[tap];
                const float cosine = dot(vec3_of(there), n);
                if (!(cosine > 0.5f)) continue;
                const float off_plane = abs(dot(in_camera, at(px, py, there.w) - point)) * per_metre;
                const float kernel = weight_of(dx) * weight_of(dy);
                const float bend = 1.0f - min(cosine, 1.0f);
                of_diffuse.add(from.diffuse[tap], kernel, off_plane + 64.0f * bend);
                if (has_gloss && abs(albedo[tap].w - alpha) < 0.1f + 0.2f * alpha) {
                    of_gloss.add(from.gloss[tap], kernel,
                                 off_plane + (64.0f + 8.0f / max(alpha, 0.002f)) * bend +
                                     static_cast<float>(step) * gloss_narrowness(alpha));
                }
            }
        }
        to.diffuse[pixel] = of_diffuse.mean();
        to.gloss[pixel] = of_gloss.mean();
    }

private:
    /// Of one signal: values by their weights, variances by the squares of these.
    struct Sum {
        Rgb light;
        float variance, weight = 1, centre, inv_deviation;

        HD Sum(Float4 own, float deviation)
            : light(rgb_of(own)), variance(own.w), centre(luminance(rgb_of(own))),
              inv_deviation(1.0f / (4.0f * deviation + 1e-4f)) {}
        HD void add(Float4 tap, float kernel, float difference) {
            const float unlike = abs(luminance(rgb_of(tap)) - centre) * inv_deviation;
            const float w = kernel * exp(-(difference + unlike));
            light += w * rgb_of(tap);
            variance += w * w * tap.w;
            weight += w;
        }
        HD Float4 mean() const {
            const float inv = 1.0f / weight;
            return with_w(inv * light, inv * inv * variance);
        }
    };

    /// Of the B3 spline, over that of the centre tap.
    HD static float weight_of(int offset) {
        const int away = offset < 0 ? -offset : offset;
        return away == 0 ? 1.0f : (away == 1 ? 2.0f / 3.0f : 1.0f / 6.0f);
    }
    /// Reflections by sharp lobes have detail of their own: how much a tap a pixel away counts less.
    HD static float gloss_narrowness(float alpha) { return 1.0f / (1.0f + square(64.0f * alpha)); }

    HD Vec3 at(int x, int y, float depth) const {
        return point_seen(camera, {static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f}, depth);
    }
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
