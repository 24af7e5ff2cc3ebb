#pragma once

// Fourth stage, repeated: a mean over neighbours at doubling distances, which follows the guides (plane, normal,
// object) and stops where light differs by more than its own deviation explains.
//
// Sources: Dammertz et al., "Edge-Avoiding A-Trous Wavelet Transform for fast Global Illumination Filtering", HPG 2010;
// Schied et al. 2017 (reconstruction.h), section 4.4 (variance in the weight of light, and filtered along).

#include "denoise/reconstruction_view.h"
#include "render/row_band.h"

namespace pertev {

struct WaveletPass {
    const Float4* guide; // guide of the current frame's HistoryView
    SignalsView from, to;
    CameraView camera;
    uint32_t width, height;
    int step;          // pixels between taps
    float tolerance;   // deviations of diffuse light; taps that differ by four times as much do not count
    float min_trust;   // trust in guides where light is noisy, (0, 1]; 1: as anywhere else
    bool has_gloss;    // see AccumulateSignals
    RowBand band = {}; // the rows to be made

    HD void operator()(uint32_t i) const {
        const PixelPosition at = tiled_in_band(i, width, band);
        const uint32_t pixel = at.y * width + at.x;
        const Float4 own = guide[pixel], diffuse = from.diffuse[pixel],
                     gloss = has_gloss ? from.gloss[pixel] : Float4{0, 0, 0, 0};
        if (object_of(own) == kNoHit) {
            to.diffuse[pixel] = diffuse;
            if (has_gloss) to.gloss[pixel] = gloss;
            return;
        }
        // Rows and columns of the three by three taps; at the picture's edges some coincide.
        const Vec3 normal = normal_of(own);
        const Plane plane(camera, normal, depth_of(own), static_cast<int>(at.x), static_cast<int>(at.y), step);
        int columns[3], rows[3];
        float on_columns[3], on_rows[3];
        for (int k = 0; k < 3; ++k) {
            const int x = held(static_cast<int>(at.x), (k - 1) * step, static_cast<int>(width)),
                      y = held(static_cast<int>(at.y), (k - 1) * step, static_cast<int>(height));
            columns[k] = x;
            rows[k] = y * static_cast<int>(width);
            on_columns[k] = plane.on_column(x);
            on_rows[k] = plane.on_row(y);
        }
        const float alpha = alpha_of(own);
        const float variance = variance_of(from.diffuse, diffuse.w, rows, columns),
                    gloss_variance = has_gloss ? variance_of(from.gloss, gloss.w, rows, columns) : 0.0f;
        Sum of_diffuse(diffuse, variance, tolerance);
        Sum of_gloss(gloss, gloss_variance, kOfGloss);
        const float bend_of_diffuse = 64.0f * trust(of_diffuse.centre, variance);
        // Curvature makes reflections diverge, and roughness limits how much reflections of neighbours differ.
        const float bend_of_gloss = 64.0f + 8.0f / max(alpha, 0.002f),
                    trust_of_gloss = has_gloss ? trust(of_gloss.centre, gloss_variance) : 1.0f,
                    narrow = trust_of_gloss * static_cast<float>(step) / (1.0f + square(64.0f * alpha));
        for (int k = 0; k < 9; ++k) {
            if (k == 4) continue;
            const int row = k / 3, column = k % 3, tap = rows[row] + columns[column];
            const Float4 there = guide[tap];
            if (object_of(there) != object_of(own)) continue;
            const float bend = max(1.0f - fused_dot(normal_of(there), normal), 0.0f),
                        off = plane.distance(on_columns[column] + on_rows[row], depth_of(there));
            const float kernel = row == 1 || column == 1 ? 0.5f : 0.25f; // tent weight relative to that of the centre
            of_diffuse.add(from.diffuse[tap], kernel, fma(bend_of_diffuse, bend, off));
            if (has_gloss && abs(alpha_of(there) - alpha) < 0.1f + 0.2f * alpha) {
                of_gloss.add(from.gloss[tap], kernel, fma(bend_of_gloss, bend, off) + narrow);
            }
        }
        to.diffuse[pixel] = of_diffuse.mean();
        if (has_gloss) to.gloss[pixel] = of_gloss.mean();
    }

private:
    static constexpr float kOfGloss = 8;       // tolerance
    static constexpr float kSurest = 0x1p-12f; // least ratio of variances, so that a tap of black samples still counts

    /// Trust in guides other than the light itself, from min_trust to 1: the noisier the light, the less. If a
    /// sample says little, light of neighbours with other normals is nearer to the truth than its own; otherwise each
    /// bump of a normal map would keep its noise.
    HD float trust(float light, float variance) const {
        const float square_light = fma(light, light, 1e-12f);
        return max(min_trust, square_light / fma(2.0f, variance, square_light)); // in this order, NaN gives min_trust
    }

    /// Approximates x^(-1/4) of a normal x > 0 to 4 %: an exponent's bits are a logarithm.
    HD static float inverse_fourth_root(float x) { return float_of(0x4f58cae5u - (bits_of(x) >> 2)); }

    /// Approximates exp(-x) at a fifth of its cost: (1 - x / 4)^4, and 0 from 4 on.
    HD static float falloff(float x) { return square(square(max(fma(-0.25f, x, 1.0f), 0.0f))); }

    /// The plane of the surface at a pixel. In camera space a point is linear in its pixel, times the view's growth.
    struct Plane {
        float at_zero, per_column, per_row, per_depth, here;
        ViewGrowth growth;

        HD Plane(const CameraView& camera, Vec3 normal, float depth, int x, int y, int step)
            : growth(growth_of(camera)) {
            const Vec3 n = transform_transposed(camera.world_from_camera, normal);
            // Distances are measured in units of a tap's step at this depth.
            const float size = pixel_size(camera, depth);
            const float scale = 1.0f / (size * static_cast<float>(step));
            per_column = scale * (n.x * (2.0f * camera.inv_width * camera.half_width));
            per_row = -scale * (n.y * (2.0f * camera.inv_height * camera.half_height));
            at_zero = 0.5f * (per_column + per_row) + scale * (n.y * (camera.centre.y * camera.half_height) -
                                                               n.x * (camera.centre.x * camera.half_width));
            per_depth = -scale * n.z;
            here = 0;
            here = signed_distance(on_column(x) + on_row(y), depth);
        }
        /// Contributions of a pixel's column and row to the position.
        HD float on_column(int x) const { return fma(per_column, static_cast<float>(x), at_zero); }
        HD float on_row(int y) const { return per_row * static_cast<float>(y); }
        HD float signed_distance(float in_view, float depth) const {
            return fma(growth.at(depth), in_view, fma(per_depth, depth, -here));
        }
        HD float distance(float in_view, float depth) const { return abs(signed_distance(in_view, depth)); }
    };

    /// Weighted sum of one signal: values by their weights, variances by the squares of these.
    struct Sum {
        Rgb light;
        float variance, weight = 1, centre, inv_deviation, inv_around;

        /// `around` is the variance at the pixel and beside it. A tap counts up to `tolerance` deviations.
        HD Sum(Float4 own, float around, float tolerance)
            : light(rgb_of(own)), variance(own.w), centre(fused_luminance(rgb_of(own))),
              inv_deviation(1.0f / (tolerance * safe_sqrt(around) + 1e-4f)), inv_around(1.0f / max(around, 1e-20f)) {
            if (own.w < 0) weight = variance = inv_deviation = 0; // unknown, so any light is as good
        }
        HD void add(Float4 tap, float kernel, float difference) {
            const float unlike = abs(fused_luminance(rgb_of(tap)) - centre);
            // A tap that is surer than the pixel takes little of its light. If the pixel took as much of the tap's as
            // its own variance allows, light would be lost beside each bright and noisy spot. The deviation is then the
            // geometric mean of both.
            const float inv = inv_deviation * max(inverse_fourth_root(max(kSurest, tap.w * inv_around)), 1.0f);
            const float w = tap.w < 0 ? 0.0f : kernel * falloff(fma(unlike, inv, difference));
            light = add_scaled(light, w, rgb_of(tap));
            variance = fma(w * w, tap.w, variance);
            weight += w;
        }
        HD Float4 mean() const {
            if (!(weight > 0)) return {0, 0, 0, kUnknownSignal};
            const float inv = 1.0f / weight;
            return with_w(inv * light, inv * inv * variance);
        }
    };

    /// Variance of the light at a pixel, averaged over its neighbours because variances are noisy themselves.
    HD float variance_of(const Float4* signal, float own, const int* rows, const int* columns) const {
        float sum = 4.0f * max(own, 0.0f);
        for (int k = 0; k < 9; ++k) {
            if (k == 4) continue;
            sum = fma(k % 2 == 1 ? 2.0f : 1.0f, max(signal[rows[k / 3] + columns[k % 3]].w, 0.0f), sum);
        }
        return sum * (1.0f / 16.0f);
    }
};

} // namespace pertev
