#pragma once

// Data that stages of the reconstruction exchange, as arrays with one element per pixel, row by row. Data that lives
// from frame to frame is double-buffered: the previous frame is read while the current one is written.
//
// A *signal* is light that the first surface scatters, divided by its reflectance (demodulated), so that it is smooth
// where a texture is not. There are two, for diffuse lobes and for others.

#include <cstdint>

#include "base/limits.h"
#include "math/float4.h"
#include "math/rgb.h"
#include "math/vec2.h"
#include "math/vec3.h"
#include "render/noisy_frame_view.h"
#include "render/reproject.h"

namespace pertev {

/// Data of a frame that the next one needs.
struct HistoryView {
    Float4* guide;   // packed Guide
    Float4* diffuse; // mean of the signal over the frames that saw this surface point; their number, 0 if unknown
    Float4* gloss;   // mean of the gloss signal over the same frames
    Vec2* squares;   // mean square of the luminances of both
    Float4* recent;  // means over few frames: rgb diffuse (r is kUnknownSignal if unknown), luminance of the other
    Float4* shown;   // the reconstructed picture as shown_color; w: see AntiAlias
};

/// The surface of a pixel, for filters.
struct Guide {
    Vec3 normal;     // unit up to 2^-15, on the camera's side; 0 without a hit
    float alpha;     // GGX width of the sharpest non-diffuse lobe, 1 without one
    float depth;     // along the camera's axis, metres
    uint32_t object; // object_with; kNoHit: no hit
};

/// A contact tells whether something is close above a surface (contacts.h).
enum class Contact : uint32_t { Unknown = 0, Open = 1, Covered = 2 };

// Contacts of a frame are kept where the G-buffer has the width of a lobe, as its sign.

HD inline void store_contact(const GBufferView& frame, uint32_t pixel, bool is_covered) {
    const float alpha = abs(frame.albedo[pixel].w);
    frame.albedo[pixel].w = is_covered ? -alpha : alpha;
}
HD inline Contact contact_of(const GBufferView& frame, uint32_t pixel) {
    return bits_of(frame.albedo[pixel].w) >> 31 != 0 ? Contact::Covered : Contact::Open;
}

// The object of a guide is the instance, and in the highest two bits the contact. Thus filters, which compare objects,
// separate contacts, too.

static_assert(kMaxInstances <= 1u << 30);
HD inline uint32_t object_with(uint32_t instance, Contact contact) {
    return instance == kNoHit ? kNoHit : instance | static_cast<uint32_t>(contact) << 30;
}
HD inline uint32_t instance_of(uint32_t object) { return object == kNoHit ? kNoHit : object & 0x3fffffffu; }
HD inline bool knows_contact(uint32_t object) { return object != kNoHit && object >> 30 != 0; }
/// Returns whether one of two objects is open and the other covered.
HD inline bool differ_in_contact(uint32_t a, uint32_t b) { return a != kNoHit && b != kNoHit && (a ^ b) >> 30 == 3; }
/// Returns whether objects of different frames may be the same: the contact of one may be unknown.
HD inline bool may_be_same(uint32_t a, uint32_t b) {
    const uint32_t difference = a ^ b;
    return (difference & 0x3fffffffu) == 0 && difference >> 30 != 3;
}

/// Packs a guide into sixteen bytes, because it is read for each tap of each filter.
HD inline Float4 pack(const Guide& g) {
    const auto bits = [](float x, float scale, float zero) {
        return static_cast<uint32_t>(clamp(fma(x, scale, zero + 0.5f), 0.0f, 65535.0f));
    };
    const uint32_t x = bits(g.normal.x, 32767, 32767), y = bits(g.normal.y, 32767, 32767),
                   z = bits(g.normal.z, 32767, 32767), alpha = bits(g.alpha, 65535, 0);
    return {float_of(x | y << 16), float_of(z | alpha << 16), g.depth, float_of(g.object)};
}
HD inline uint32_t object_of(Float4 packed) { return bits_of(packed.w); }
HD inline float depth_of(Float4 packed) { return packed.z; }
/// Unpacks the normal of a guide. 2^23 + n is the float whose lowest bits are n, which is cheaper than a conversion.
HD inline Vec3 normal_of(Float4 packed) {
    constexpr uint32_t k2To23 = 0x4b000000;
    constexpr float kZero = 8388608.0f + 32767.0f, kScale = 1.0f / 32767.0f;
    const uint32_t xy = bits_of(packed.x), z = bits_of(packed.y);
    return {kScale * (float_of(k2To23 | (xy & 0xffff)) - kZero), kScale * (float_of(k2To23 | xy >> 16) - kZero),
            kScale * (float_of(k2To23 | (z & 0xffff)) - kZero)};
}
HD inline float alpha_of(Float4 packed) {
    return (1.0f / 65535.0f) * (float_of(0x4b000000 | bits_of(packed.y) >> 16) - 8388608.0f);
}

/// The two signals, each with the variance of its mean's luminance.
struct SignalsView {
    Float4* diffuse; // rgb, variance or kUnknownSignal
    Float4* gloss;
};

// Sums of products with one rounding, thus one instruction, each.
HD inline float fused_dot(Vec3 a, Vec3 b) { return fma(a.x, b.x, fma(a.y, b.y, a.z * b.z)); }
HD inline float fused_luminance(Rgb c) { return fma(0.2126f, c.r, fma(0.7152f, c.g, 0.0722f * c.b)); }
HD inline Rgb add_scaled(Rgb sum, float scale, Rgb c) {
    return {fma(scale, c.r, sum.r), fma(scale, c.g, sum.g), fma(scale, c.b, sum.b)};
}

/// `x + offset` clamped to [0, count).
HD inline int held(int x, int offset, int count) { return clamp(x + offset, 0, count - 1); }

/// Divisor of the diffuse signal at a pixel: the reflectance of its diffuse lobes as the camera sees them, so that
/// the signal of a point does not depend on the view.
HD inline Rgb diffuse_divisor(const NoisyFrameView& frame, uint32_t pixel) {
    return frame.emission[pixel].w * rgb_of(frame.albedo[pixel]);
}
/// Divisor of the other signal, which is a coarser estimate of reflectance and therefore not small.
HD inline Rgb gloss_divisor(const NoisyFrameView& frame, uint32_t pixel) {
    constexpr float kLeast = 0.01f;
    const Float4 albedo = frame.gloss[pixel];
    return {max(albedo.x, kLeast), max(albedo.y, kLeast), max(albedo.z, kLeast)};
}

/// w of a diffuse signal that is unknown because the surface is black. No mean counts it, otherwise what is beside
/// black would be darkened.
inline constexpr float kUnknownSignal = -1;
/// Least reflectance of a channel whose light is known.
inline constexpr float kLeastKnown = 1e-4f;

/// The diffuse signal of light over its divisor; w is 0 or kUnknownSignal. A channel in which the surface is black is
/// that of the others, so that saturated colours do not tint what is beside them more than their light is tinted.
HD inline Float4 diffuse_signal(Rgb light, Rgb divisor) {
    float known = 0, sum = 0;
    const auto channel = [&](float of_light, float of_divisor) {
        if (!(of_divisor >= kLeastKnown)) return kUnknownSignal;
        const float signal = of_light / of_divisor;
        sum += signal;
        known += 1;
        return signal;
    };
    Rgb signal;
    signal.r = channel(light.r, divisor.r);
    signal.g = channel(light.g, divisor.g);
    signal.b = channel(light.b, divisor.b);
    if (!(known > 0)) return {0, 0, 0, kUnknownSignal};
    const float others = sum / known;
    return {signal.r < 0 ? others : signal.r, signal.g < 0 ? others : signal.g, signal.b < 0 ? others : signal.b, 0};
}

} // namespace pertev
