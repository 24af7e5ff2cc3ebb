#pragma once

// Splits the light of one sample into signals and divides them by the reflectance of the surface (demodulation).
//
// Source: Schied et al. 2017 (reconstruction.h), section 3.

#include "denoise/reconstruction_view.h"

namespace pertev {

/// Scattered light of the first surface, and the divisors of diffuse_signal and of the other signal.
struct SplitLight {
    Rgb diffuse, gloss;
    Rgb diffuse_divisor, gloss_divisor;
};

HD inline SplitLight split_light(const NoisyFrameView& frame, uint32_t pixel) {
    const auto not_negative = [](Rgb c) { return Rgb{max(c.r, 0.0f), max(c.g, 0.0f), max(c.b, 0.0f)}; };
    const Float4 light = frame.light[pixel];
    Rgb diffuse = {0, 0, 0}, gloss = {0, 0, 0};
    if (light.w != 0) {
        const Rgb scattered = rgb_of(light) - rgb_of(frame.emission[pixel]);
        diffuse = frame.splits_light() ? rgb_of(frame.diffuse[pixel]) : scattered;
        gloss = frame.splits_light() ? not_negative(scattered - diffuse) : Rgb{0, 0, 0};
    }
    diffuse = not_negative(diffuse);
    const Rgb divisor = diffuse_divisor(frame, pixel);
    if (frame.splits_light()) {
        // Where the base is black, sheen, fuzz and what a leaf transmits are of the other signal, because no divisor
        // says what they reflect.
        const auto move = [](float of_divisor, float& of_diffuse, float& of_gloss) {
            if (of_divisor >= kLeastKnown) return;
            of_gloss += of_diffuse;
            of_diffuse = 0;
        };
        move(divisor.r, diffuse.r, gloss.r);
        move(divisor.g, diffuse.g, gloss.g);
        move(divisor.b, diffuse.b, gloss.b);
    }
    return {diffuse, gloss, divisor, gloss_divisor(frame, pixel)};
}

} // namespace pertev
