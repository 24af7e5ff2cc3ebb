#pragma once

// What a single picture is reconstructed from (denoise/picture_denoiser.h): for each pixel the surface that the ray
// through its centre meets, its *guide*; sums over what the pixel's camera rays meet, its *features*, and over the
// light of its samples. A sample that met the guide's surface tells of the light there. One that met another, as at
// edges, counts for the picture with its own colours, but the light on these is taken from a pixel beside it whose
// guide shows that surface. So guides and light are sharp at every edge while the picture is not jagged.

#include "denoise/reconstruction_view.h"

namespace pertev {

/// Of the rays through pixels' centres, from the middle of the lens.
struct PictureGuide {
    Float4* normal;   // NoisyFrameView's
    Float4* albedo;   // NoisyFrameView's
    uint32_t* object; // instance; kNoHit: nothing
};

/// Other surfaces that samples of one pixel may meet and be told apart.
inline constexpr int kSurfacesBeside = 2;

/// A pixel's light is that of its samples over the sum of their divisors, not the mean of their signals: what a normal
/// map makes bright where its texture is bright stays so.
struct PictureSums {
    // Of light.
    Float4* diffuse;       // rgb of samples that met the guide's surface, scattered by diffuse lobes; their number
    Float4* gloss;         // rgb, scattered by others
    Float4* diffuse_share; // rgb of divisors of these samples; luminances of the signal
    Float4* gloss_share;   // the same of the other signal
    Vec2* squares;         // of these luminances
    Float4* beside;        // rgb of samples that met a surface beside, scattered; their number
    Float4* loose;         // rgb of samples whose surface no guide about shows; their number

    // Of features.
    Float4* normal;                          // of the guide's surface; their number
    Float4* met;                             // rgb of emission; number of loose samples, whose emission is left out
    Float4* diffuse_color;                   // rgb of divisors of the guide's surface
    Float4* gloss_color;                     // the same of the other signal
    Float4* beside_diffuse[kSurfacesBeside]; // of another surface; bits of a pixel whose guide shows it, kNoHit: none
    Float4* beside_gloss[kSurfacesBeside];   // the same of the other signal; their number
};

/// Whether `point`, camera space, with the normal `normal`, lies on the surface that `guide` shows at `pixel`, whose
/// normal makes an angle with it whose cosine is greater than `cosine`.
HD inline bool shows_surface(const PictureGuide& guide, const CameraView& camera, uint32_t width, uint32_t pixel,
                             uint32_t object, Vec3 point, Vec3 normal, float cosine) {
    if (guide.object[pixel] != object) return false;
    const Float4 there = guide.normal[pixel];
    if (!(dot(vec3_of(there), normal) > cosine)) return false;
    const Vec2 centre = {static_cast<float>(pixel % width) + 0.5f, static_cast<float>(pixel / width) + 0.5f};
    const Vec3 n = transform_transposed(camera.world_from_camera, vec3_of(there));
    const float off = abs(dot(n, point - point_seen(camera, centre, there.w)));
    return off <= 2.0f * pixel_size(camera, abs(there.w));
}

} // namespace pertev
