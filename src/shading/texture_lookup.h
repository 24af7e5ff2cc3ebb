#pragma once

// Texture lookup: coordinate transform, wrap, nearest or bilinear filter, in our own arithmetic on both devices (a
// texture unit filters with 8 fraction bits, and differently on each card). sRGB is decoded per texel before
// filtering, as glTF 2.0 section 3.9.2 requires. Between two levels of a mip-map the filter is linear.

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#include "base/host_device.h"
#include "math/scalar.h"
#include "math/vec2.h"
#include "math/vec4.h"
#include "scene/scene.h"
#include "scene/texture.h"

namespace pertev {

/// The number format of an image's channels. On the host there are bytes and floats; a device has the smallest one
/// that holds the same values (device_scene/pack_texels.h).
enum class TexelDepth : uint8_t {
    Byte,
    Half,    // linear, finite
    Unorm16, // linear, [0, 1]
    Srgb16,  // [0, 1]; colours are sRGB-encoded, alpha is linear
    Float,   // linear
};

/// Pixels of one image; exactly one pointer is set. Row 0 is the top row.
struct TextureImageView {
    uint32_t width = 0, height = 0;    // size of the image, at least 1 x 1
    const uint8_t* rgba8 = nullptr;    // [height * width * 4], 4-byte aligned
    const float* rgba_float = nullptr; // [height * width * 4], 16-byte aligned
    const uint16_t* rgba16 = nullptr;  // [height * width * 4], 8-byte aligned
    TexelDepth depth = TexelDepth::Byte;
    uint8_t coarser_levels = 0; // number of further levels of its mip-map
    uint32_t first_coarser = 0; // where they begin in the array of images
};

/// Number of entries of linear_from_srgb: those of bytes, and behind them those of 16-bit values, which only scenes
/// with such an image have.
inline constexpr uint32_t kSrgbBytes = 256, kSrgbWords = 65536;

/// Texels that a lookup reads along one axis: i0 and i1, the second with weight t.
struct TexelPair {
    uint32_t i0 = 0, i1 = 0;
    float t = 0;
};

/// Wraps coordinate `u` (1 = one image) to [0, 1]; 0 for NaN and infinity. It is exact for u >= 0, so precision does
/// not depend on the number of repetitions.
HD inline float wrap_coordinate(float u, Wrap wrap) {
    switch (wrap) {
    case Wrap::Repeat:
        return clamp(u - floor(u), 0.0f, 1.0f);
    case Wrap::MirroredRepeat: {
        const float twice = clamp(u - 2.0f * floor(0.5f * u), 0.0f, 2.0f);
        return twice > 1.0f ? 2.0f - twice : twice;
    }
    case Wrap::ClampToEdge:
        return clamp(u, 0.0f, 1.0f);
    }
    return 0;
}

/// Texel whose cell contains the coordinate.
HD inline uint32_t nearest_texel(float u, Wrap wrap, uint32_t size) {
    const int last = static_cast<int>(size) - 1;
    return static_cast<uint32_t>(to_int(wrap_coordinate(u, wrap) * static_cast<float>(size), 0, last));
}

/// The two texels whose centres enclose the coordinate.
HD inline TexelPair linear_texels(float u, Wrap wrap, uint32_t size) {
    const int last = static_cast<int>(size) - 1;
    const float x = wrap_coordinate(u, wrap) * static_cast<float>(size) - 0.5f;
    const float below = floor(x);
    const int i0 = to_int(below, -1, last), i1 = i0 + 1;
    // Beyond an edge lies the opposite edge if the image repeats, and the same texel if it mirrors or clamps.
    const bool repeats = wrap == Wrap::Repeat;
    return {static_cast<uint32_t>(i0 < 0 ? (repeats ? last : 0) : i0),
            static_cast<uint32_t>(i1 > last ? (repeats ? 0 : last) : i1), x - below};
}

/// A finite half as a float. The product is exact, also for denormal halves.
HD inline float float_of_half(uint32_t half) {
    return float_of((half & 0x8000u) << 16 | bits_of(float_of((half & 0x7fffu) << 13) * 0x1p112f));
}

/// Returns word / 65535, correctly rounded without a division.
HD inline float unit_of_word(uint32_t word) {
    constexpr float inv = 1.0f / 65535.0f;
    const float value = static_cast<float>(word), quotient = value * inv;
    return fma(fma(-quotient, 65535.0f, value), inv, quotient);
}

/// Returns a texel of an image of another depth than bytes.
HD_CALL inline Vec4 load_deep_texel(const TextureImageView& image, size_t texel, const float* linear_from_srgb) {
    if (image.depth == TexelDepth::Float) {
        Vec4 value;
        memcpy(&value, __builtin_assume_aligned(image.rgba_float + texel, 16), 16);
        return value;
    }
    uint32_t pairs[2];
    memcpy(pairs, __builtin_assume_aligned(image.rgba16 + texel, 8), 8);
    const uint32_t r = pairs[0] & 0xffffu, g = pairs[0] >> 16, b = pairs[1] & 0xffffu, a = pairs[1] >> 16;
    if (image.depth == TexelDepth::Half) {
        return {float_of_half(r), float_of_half(g), float_of_half(b), float_of_half(a)};
    }
    if (image.depth == TexelDepth::Unorm16) {
        return {unit_of_word(r), unit_of_word(g), unit_of_word(b), unit_of_word(a)};
    }
    const float* of_words = linear_from_srgb + kSrgbBytes;
    return {of_words[r], of_words[g], of_words[b], unit_of_word(a)};
}

/// Returns a texel as linear RGBA. `linear_from_srgb` is used for the colours of sRGB-encoded images.
HD inline Vec4 load_texel(const TextureImageView& image, uint32_t x, uint32_t y, bool is_srgb,
                          const float* linear_from_srgb) {
    const size_t texel = 4 * (size_t(y) * image.width + x);
    if (image.rgba8 != nullptr) {
        uint32_t packed;
        memcpy(&packed, __builtin_assume_aligned(image.rgba8 + texel, 4), 4); // one load on both devices
        const uint32_t r = packed & 255u, g = packed >> 8 & 255u, b = packed >> 16 & 255u;
        constexpr float unit = 1.0f / 255.0f; // 255 * unit rounds to 1
        const float alpha = static_cast<float>(packed >> 24) * unit;
        if (is_srgb) return {linear_from_srgb[r], linear_from_srgb[g], linear_from_srgb[b], alpha};
        return {static_cast<float>(r) * unit, static_cast<float>(g) * unit, static_cast<float>(b) * unit, alpha};
    }
    return load_deep_texel(image, texel, linear_from_srgb);
}

HD inline float channel_of(Vec4 texel, uint32_t channel) {
    return channel == 0 ? texel.x : channel == 1 ? texel.y : channel == 2 ? texel.z : texel.w;
}

/// Returns channel 0 to 3 of a texel, linear.
HD inline float load_texel_channel(const TextureImageView& image, uint32_t x, uint32_t y, uint32_t channel,
                                   bool is_srgb, const float* linear_from_srgb) {
    const size_t texel = 4 * (size_t(y) * image.width + x);
    if (image.rgba8 != nullptr) {
        const uint32_t encoded = image.rgba8[texel + channel];
        return is_srgb && channel < 3 ? linear_from_srgb[encoded] : static_cast<float>(encoded) * (1.0f / 255.0f);
    }
    return channel_of(load_deep_texel(image, texel, linear_from_srgb), channel);
}

HD inline Vec2 transform_uv(const TextureRef& ref, Vec2 uv) {
    return {ref.m00 * uv.x + ref.m01 * uv.y + ref.m02, ref.m10 * uv.x + ref.m11 * uv.y + ref.m12};
}

/// Interpolates from `a` at t = 0 to `b` at t = 1; exact for equal ends.
HD inline Vec4 mix_texels(Vec4 a, Vec4 b, float t) {
    return {lerp(a.x, b.x, t), lerp(a.y, b.y, t), lerp(a.z, b.z, t), lerp(a.w, b.w, t)};
}

/// Linear RGBA of an image at `at`, coordinates that transform_uv has transformed.
HD inline Vec4 lookup_image(const TextureImageView& image, const TextureRef& ref, Vec2 at,
                            const float* linear_from_srgb) {
    if (ref.filter == TextureFilter::Nearest) {
        return load_texel(image, nearest_texel(at.x, ref.wrap_s, image.width),
                          nearest_texel(at.y, ref.wrap_t, image.height), ref.is_srgb, linear_from_srgb);
    }
    const TexelPair x = linear_texels(at.x, ref.wrap_s, image.width);
    const TexelPair y = linear_texels(at.y, ref.wrap_t, image.height);
    const Vec4 top = mix_texels(load_texel(image, x.i0, y.i0, ref.is_srgb, linear_from_srgb),
                                load_texel(image, x.i1, y.i0, ref.is_srgb, linear_from_srgb), x.t);
    const Vec4 bottom = mix_texels(load_texel(image, x.i0, y.i1, ref.is_srgb, linear_from_srgb),
                                   load_texel(image, x.i1, y.i1, ref.is_srgb, linear_from_srgb), x.t);
    return mix_texels(top, bottom, y.t);
}

/// Linear RGBA at `uv` (in the set that `ref.uv_set` names); white if `ref` has no image. Any float is a valid
/// coordinate.
HD inline Vec4 lookup_texture(const TextureImageView* images, const TextureRef& ref, Vec2 uv,
                              const float* linear_from_srgb) {
    if (ref.image == kNoImage) return {1, 1, 1, 1};
    return lookup_image(images[ref.image], ref, transform_uv(ref, uv), linear_from_srgb);
}

/// Level of a mip-map for a footprint of `area` texels of the image, its own being 0: half of a logarithm to base 2,
/// linear between powers of two, which is at most 0.05 less. 0 for NaN.
HD inline float mip_level(float area) {
    if (!(area > 1)) return 0;
    return static_cast<float>(bits_of(area) - bits_of(1.0f)) * 0x1p-24f;
}

/// Linear RGBA at `uv` from a level of the mip-map of the image of `ref`, which it has, or from the last one.
HD inline Vec4 lookup_mip_map(const TextureImageView* images, const TextureRef& ref, Vec2 uv, float level,
                              const float* linear_from_srgb) {
    const TextureImageView& finest = images[ref.image];
    const Vec2 at = transform_uv(ref, uv);
    const int last = finest.coarser_levels;
    const float clamped = clamp(level, 0.0f, static_cast<float>(last));
    const int below = to_int(clamped, 0, last);
    const float t = clamped - static_cast<float>(below);
    const uint32_t next = finest.first_coarser + static_cast<uint32_t>(below); // the first one has level 1
    const Vec4 fine = lookup_image(below == 0 ? finest : images[next - 1], ref, at, linear_from_srgb);
    if (!(t > 0)) return fine;
    return mix_texels(fine, lookup_image(images[next], ref, at, linear_from_srgb), t);
}

/// Channel `ref.channel` at `uv`, equal to that component of lookup_texture; 1 if `ref` has no image.
HD inline float lookup_texture_channel(const TextureImageView* images, const TextureRef& ref, Vec2 uv,
                                       const float* linear_from_srgb) {
    if (ref.image == kNoImage) return 1;
    const TextureImageView& image = images[ref.image];
    const Vec2 at = transform_uv(ref, uv);
    const uint32_t channel = ref.channel;
    if (ref.filter == TextureFilter::Nearest) {
        return load_texel_channel(image, nearest_texel(at.x, ref.wrap_s, image.width),
                                  nearest_texel(at.y, ref.wrap_t, image.height), channel, ref.is_srgb,
                                  linear_from_srgb);
    }
    const TexelPair x = linear_texels(at.x, ref.wrap_s, image.width);
    const TexelPair y = linear_texels(at.y, ref.wrap_t, image.height);
    const float top = lerp(load_texel_channel(image, x.i0, y.i0, channel, ref.is_srgb, linear_from_srgb),
                           load_texel_channel(image, x.i1, y.i0, channel, ref.is_srgb, linear_from_srgb), x.t);
    const float bottom = lerp(load_texel_channel(image, x.i0, y.i1, channel, ref.is_srgb, linear_from_srgb),
                              load_texel_channel(image, x.i1, y.i1, channel, ref.is_srgb, linear_from_srgb), x.t);
    return lerp(top, bottom, y.t);
}

/// View of an image in host memory, valid as long as the image.
inline TextureImageView view_of(const TextureImage& image) {
    if (!image.rgba8.pixels.empty()) {
        return {.width = image.rgba8.width, .height = image.rgba8.height, .rgba8 = image.rgba8.pixels.data()};
    }
    return {.width = image.rgba_float.width,
            .height = image.rgba_float.height,
            .rgba_float = image.rgba_float.pixels.data(),
            .depth = TexelDepth::Float};
}

/// Views of all images of a scene, with the same indices.
inline std::vector<TextureImageView> views_of_images(const Scene& scene) {
    std::vector<TextureImageView> views;
    views.reserve(scene.images.size());
    for (const TextureImage& image : scene.images) views.push_back(view_of(image));
    return views;
}

} // namespace pertev
