#pragma once

// Tone mapping of scene light for a display: linear Rec. 709 in, sRGB-encoded [0, 1] out, on either device.
//   Srgb     clamps, then encodes
//   Agx      Sobotka's AgX, base look: log2 encoding and a sigmoid in rotated, inset primaries. Curve and matrices of
//            Wrensch, "Minimal AgX Implementation", iolite-engine.com, 2023 (polynomial of degree 6)
//   Aces     Hill's fit of the ACES RRT and sRGB ODT, in BakingLab (Pettineo and Neubelt), ACES.hlsl
//   Neutral  Khronos PBR Neutral Tone Mapper, specification 1.0, 2024

#include <cstdint>

#include "base/host_device.h"
#include "image/srgb.h"
#include "math/portable_math.h"
#include "math/rgb.h"

namespace pertev {

enum class ToneMap : uint8_t { Srgb, Agx, Aces, Neutral };

namespace tone {

HD inline float dot3(float a, float b, float c, Rgb v) { return a * v.r + b * v.g + c * v.b; }
HD inline Rgb clamp_to_unit(Rgb c) { return {clamp(c.r, 0.0f, 1.0f), clamp(c.g, 0.0f, 1.0f), clamp(c.b, 0.0f, 1.0f)}; }

// Log2 range of AgX around middle grey, in stops of scene light: 0.18 * 2^-10 to 0.18 * 2^6.5.
HD inline float agx_curve(float light) {
    constexpr float kLowest = -12.47393f, kHighest = 4.026069f;
    if (!(light > 0)) return 0.0f;
    const float x = (clamp(log2(light), kLowest, kHighest) - kLowest) / (kHighest - kLowest);
    const float x2 = x * x, x4 = x2 * x2;
    return 15.5f * x4 * x2 - 40.14f * x4 * x + 31.96f * x4 - 6.868f * x2 * x + 0.4298f * x2 + 0.1191f * x - 0.00232f;
}

HD inline Rgb agx(Rgb c) {
    const Rgb in = {agx_curve(dot3(0.842479062253094f, 0.0784335999999992f, 0.0792237451477643f, c)),
                    agx_curve(dot3(0.0423282422610123f, 0.878468636469772f, 0.0791661274605434f, c)),
                    agx_curve(dot3(0.0423756549057051f, 0.0784336f, 0.879142973793104f, c))};
    return clamp_to_unit({dot3(1.19687900512017f, -0.0980208811401368f, -0.0990297440797205f, in),
                          dot3(-0.0528968517574562f, 1.15190312990417f, -0.0989611768448433f, in),
                          dot3(-0.0529716355144438f, -0.0980434501171241f, 1.15107367264116f, in)});
}

HD inline float aces_curve(float v) {
    return (v * (v + 0.0245786f) - 0.000090537f) / (v * (0.983729f * v + 0.4329510f) + 0.238081f);
}

HD inline Rgb aces(Rgb c) {
    const Rgb in = {aces_curve(dot3(0.59719f, 0.35458f, 0.04823f, c)),
                    aces_curve(dot3(0.07600f, 0.90834f, 0.01566f, c)),
                    aces_curve(dot3(0.02840f, 0.13383f, 0.83777f, c))};
    return {dot3(1.60475f, -0.53108f, -0.07367f, in), dot3(-0.10208f, 1.10813f, -0.00605f, in),
            dot3(-0.00327f, -0.07276f, 1.07602f, in)};
}

HD inline Rgb neutral(Rgb c) {
    constexpr float kF90 = 0.04f, kKnee = 0.8f - kF90, kDesaturation = 0.15f;
    const float least = min(c.r, min(c.g, c.b));
    const float offset = least < 2.0f * kF90 ? least - least * least / (4.0f * kF90) : kF90;
    c = c - grey(offset);
    const float peak = max_component(c);
    if (peak < kKnee) return c;
    constexpr float d = 1.0f - kKnee;
    const float new_peak = 1.0f - d * d / (peak + d - kKnee);
    const float to_white = 1.0f - 1.0f / (kDesaturation * (peak - new_peak) + 1.0f);
    return lerp((new_peak / peak) * c, grey(new_peak), to_white);
}

} // namespace tone

/// Factor of an exposure in stops, for tone_map.
HD inline float exposure_scale(float stops) { return exp2(stops); }

/// Tone-maps linear light times `scale` to display-encoded sRGB in [0, 1]. Any input is allowed: NaN and negative
/// values count as 0, infinity as 2^40.
HD inline Rgb tone_map(Rgb linear, ToneMap kind, float scale = 1.0f) {
    constexpr float kMaxLight = 0x1p40f; // largest light; the square of this is finite
    const Rgb c = {clamp(linear.r * scale, 0.0f, kMaxLight), clamp(linear.g * scale, 0.0f, kMaxLight),
                   clamp(linear.b * scale, 0.0f, kMaxLight)};
    switch (kind) {
    case ToneMap::Srgb:
        return srgb_encode(c);
    case ToneMap::Agx:
        return tone::agx(c); // AgX's curve ends in display code values
    case ToneMap::Aces:
        return srgb_encode(tone::aces(c));
    case ToneMap::Neutral:
        return srgb_encode(tone::neutral(c));
    }
    return {};
}

/// Writes an RGBA pixel for display. `light` is premultiplied by alpha; alpha is clamped to [0, 1] and stays linear.
HD inline void tone_map_pixel(Rgb light, float alpha, ToneMap kind, float scale, uint8_t* rgba) {
    alpha = clamp(alpha, 0.0f, 1.0f);
    if (alpha > 0 && alpha < 1) light = (1.0f / alpha) * light;
    const Rgb shown = tone_map(light, kind, scale);
    rgba[0] = to_byte(shown.r);
    rgba[1] = to_byte(shown.g);
    rgba[2] = to_byte(shown.b);
    rgba[3] = to_byte(alpha);
}

} // namespace pertev
