#pragma once

// How light on surfaces has changed since the frame before, and what that makes of a mean over frames. It is known by
// two small pictures that one camera takes by the same random numbers, of the scene as it was and as it is: what
// differs between them is the light, and little of the noise (some where a lamp's share of all light changes, as the
// same numbers then draw another lamp now and then).
//
// Source: Schied, Peters, Dachsbacher, "Gradient Estimation for Real-Time Adaptive Temporal Filtering", HPG 2018
// (A-SVGF), of which the gradients by the same random numbers are. There they shorten histories; here histories follow
// them first.

#include "denoise/reconstruction_view.h"

namespace pertev {

/// Arrays of one element a pixel of the small pictures, row by row.
struct LightChangeView {
    const Float4* guide = nullptr; // packed Guide. Null: light is not known to have changed
    const Float4* was = nullptr;   // rgb of the diffuse signal, luminance of the other one, of the scene as it was
    const Float4* is = nullptr;    // the same, as it is
    uint32_t width = 0, height = 0;
    float columns = 0, rows = 0; // of the small picture, for one of the frame
};

/// Of light about a place: equal where nothing is known.
struct LightStep {
    Rgb was = {0, 0, 0}, is = {0, 0, 0}; // of the diffuse signal
    float gloss_was = 0, gloss_is = 0;
};

/// Of what the frame before showed at `pixel`.
HD inline LightStep light_step(const LightChangeView& change, Vec2 pixel, Vec3 normal, uint32_t object) {
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

/// `light`, a mean over frames, after light about it has gone from `was` to `is`: by their ratio, but never up by more
/// than their difference.
HD inline float followed(float light, float was, float is) {
    if (!(was > 1e-12f)) return light + is; // no ratio of such numbers is one of light
    const float by_ratio = light * (is / was);
    return is > was ? min(by_ratio, light + (is - was)) : by_ratio;
}
HD inline Rgb followed(Rgb light, Rgb was, Rgb is) {
    return {followed(light.r, was.r, is.r), followed(light.g, was.g, is.g), followed(light.b, was.b, is.b)};
}

/// Frames of a mean where light changes by so much a frame: of what it follows a part is left, which adds up.
HD inline float frames_in_change(float longest, float was, float is) {
    constexpr float kLeft = 3; // frames that a mean may have where all of the light is new: one over this
    const float change = abs(is - was) / max(max(is, was), 1e-6f);
    return max(longest / fma(kLeft * change, longest, 1.0f), 1.0f);
}

} // namespace pertev
