#pragma once

// Temporal gradients: the change of light on surfaces since the previous frame, and its effect on temporal means. Two
// small pictures, of the scene as it was and as it is, are rendered with the same camera and random numbers, so that
// their difference shows the change of light with little noise (some if an emitter's share of all light changes,
// because the same numbers then occasionally select another emitter).
//
// Source: Schied, Peters, Dachsbacher, "Gradient Estimation for Real-Time Adaptive Temporal Filtering", HPG 2018
// (A-SVGF), for gradients from the same random numbers. There they shorten histories; here histories are scaled by
// them first.

#include "denoise/reconstruction_view.h"

namespace pertev {

/// Arrays with one element per pixel of the small pictures, row by row.
struct TemporalGradientsView {
    const Float4* guide = nullptr; // packed Guide. Null: light is not known to have changed
    const Float4* was = nullptr;   // rgb of the diffuse signal, luminance of the other one, of the scene as it was
    const Float4* is = nullptr;    // in the same form, of the scene as it is
    const float* share = nullptr;  // largest changed share of light around the pixel (FindChangedShare)
    uint32_t width = 0, height = 0;
    float columns = 0, rows = 0; // columns and rows of the small picture per one of the frame
};

/// Change of light around a point; `was` and `is` are equal if it is unknown.
struct LightStep {
    Rgb was = {0, 0, 0}, is = {0, 0, 0}; // diffuse signal
    float gloss_was = 0, gloss_is = 0;
};

/// Change of the light that the previous frame showed at `pixel`.
HD inline LightStep light_step(const TemporalGradientsView& change, Vec2 pixel, Vec3 normal, uint32_t object) {
    const float x = pixel.x * change.columns - 0.5f, y = pixel.y * change.rows - 0.5f;
    const int w = static_cast<int>(change.width), h = static_cast<int>(change.height);
    LightStep step;
    if (!(x > -1 && y > -1 && x < static_cast<float>(w) && y < static_cast<float>(h))) return step;
    const float left = floor(x), top = floor(y), in_x = x - left, in_y = y - top;
    const int column = to_int(left, -1, w), row = to_int(top, -1, h);
    float sum = 0;
    for (int k = 0; k < 4; ++k) {
        const int at = held(row, k >> 1, h) * w + held(column, k & 1, w);
        const Float4 seen = change.guide[at];
        if (object_of(seen) != object || !(fused_dot(normal_of(seen), normal) > 0.5f)) continue;
        const float weight = 0.01f + ((k & 1) != 0 ? in_x : 1.0f - in_x) * ((k >> 1) != 0 ? in_y : 1.0f - in_y);
        const Float4 was = change.was[at], is = change.is[at];
        step.was = add_scaled(step.was, weight, rgb_of(was));
        step.is = add_scaled(step.is, weight, rgb_of(is));
        step.gloss_was = fma(weight, was.w, step.gloss_was);
        step.gloss_is = fma(weight, is.w, step.gloss_is);
        sum += weight;
    }
    if (!(sum > 0)) return step;
    const float inv = 1.0f / sum;
    return {inv * step.was, inv * step.is, inv * step.gloss_was, inv * step.gloss_is};
}

/// Updates `light`, a temporal mean, after the light around it has changed from `was` to `is`: by their ratio, but
/// never by more than their difference upwards.
HD inline float followed(float light, float was, float is) {
    if (!(was > 1e-12f)) return light + is; // the ratio of such small numbers is meaningless
    const float by_ratio = light * (is / was);
    return is > was ? min(by_ratio, light + (is - was)) : by_ratio;
}
HD inline Rgb followed(Rgb light, Rgb was, Rgb is) {
    return {followed(light.r, was.r, is.r), followed(light.g, was.g, is.g), followed(light.b, was.b, is.b)};
}

/// Share of the light that is new or gone, in [0, 1].
HD inline float changed_share(float was, float is) { return abs(is - was) / max(max(is, was), 1e-6f); }

/// Maximum number of frames of a mean if light changes this much per frame: each update leaves an error, and errors
/// add up.
HD inline float frames_in_change(float longest, float was, float is) {
    constexpr float kLeft = 3; // frames of a mean if all of the light is new: one over this
    return max(longest / fma(kLeft * changed_share(was, is), longest, 1.0f), 1.0f);
}

} // namespace pertev
