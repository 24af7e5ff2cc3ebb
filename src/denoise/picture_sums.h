#pragma once

// Input of the reconstruction of a single picture (denoise/picture_denoiser.h): for each pixel the surface that the
// ray through its centre hits, its *guide*; sums over the hits of the pixel's camera rays, its *features*, and over
// the light of its samples. A sample on the guide's surface contributes to the light there. One on another surface,
// as at edges, contributes its own colours to the picture, but the light on these comes from a neighbouring pixel
// whose guide shows that surface. Thus guides and light are sharp at every edge while the picture is antialiased.

#include "denoise/reconstruction_view.h"

namespace pertev {

/// Hits of the rays through pixels' centres, from the middle of the lens.
struct PictureGuide {
    Float4* normal;   // see GBufferView
    Float4* albedo;   // see GBufferView
    uint32_t* object; // instance; kNoHit: no hit
};

/// Number of other surfaces that samples of one pixel may hit and that are distinguished.
inline constexpr int kNeighbourSurfaces = 2;

/// Sums of a picture's samples. The light of a pixel is that of its samples over the sum of their divisors, not the
/// mean of their signals, so that light which a normal map concentrates on the bright parts of a texture is preserved.
struct PictureSums {
    // Sums of light.
    Float4* diffuse;       // rgb of samples on the guide's surface, scattered by diffuse lobes; their number
    Float4* gloss;         // rgb, scattered by other lobes
    Float4* diffuse_share; // rgb of divisors of these samples; luminances of the signal
    Float4* gloss_share;   // divisors of these samples for the gloss signal
    Vec2* squares;         // squares of these luminances
    Float4* neighbour;     // rgb of samples on another known surface, scattered; their number
    Float4* loose;         // rgb of samples whose surface no nearby guide shows; their number

    // Sums of features.
    Float4* normal;        // normal of the guide's surface; their number
    Float4* met;           // rgb of emission; number of loose samples, whose emission is excluded
    Float4* diffuse_color; // rgb of divisors of the guide's surface
    Float4* gloss_color;   // divisors of the guide's surface for the gloss signal
    Float4* neighbour_diffuse[kNeighbourSurfaces]; // divisors of another surface; bits of a pixel whose guide shows it,
                                                   // kNoHit: none
    Float4* neighbour_gloss[kNeighbourSurfaces];   // for the other signal; their number
};

/// Returns whether `point`, camera space, with the normal `normal`, lies on the surface that `guide` shows at `pixel`,
/// whose normal must make an angle with it whose cosine exceeds `cosine`.
HD inline bool shows_surface(const PictureGuide& guide, const CameraView& camera, uint32_t width, uint32_t pixel,
                             uint32_t object, Vec3 point, Vec3 normal, float cosine) {
    if (guide.object[pixel] != object) return false;
    const Float4 there = guide.normal[pixel];
    if (!(dot(vec3_of(there), normal) > cosine)) return false;
    const Vec2 centre = {static_cast<float>(pixel % width) + 0.5f, static_cast<float>(pixel / width) + 0.5f};
    const Vec3 n = transform_transposed(camera.world_from_camera, vec3_of(there));
    const float off = abs(dot(n, point - unproject_point(camera, centre, there.w)));
    return off <= 2.0f * pixel_size(camera, abs(there.w));
}

} // namespace pertev
