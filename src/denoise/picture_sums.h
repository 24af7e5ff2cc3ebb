#pragma once

// Input of the reconstruction of a single picture (denoise/picture_denoiser.h): for each pixel the surface that the
// ray through its centre hits, its *guide*; sums over the hits of the pixel's camera rays, its *features*, and over
// the light of its samples. A sample on the guide's surface contributes to the light there. One on another surface,
// as at edges, contributes its own colours to the picture, but the light on these comes from a neighbouring pixel
// whose guide shows that surface. Thus guides and light are sharp at every edge while the picture is antialiased.

#include "denoise/exact_sums.h"
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

/// Places of exact sums over a picture's samples in ExactSums.
struct SampleSums {
    using Light = SumsOfRgb<LightSum>;
    using Color = SumsOfRgb<SmallSum<3>>; // for divisors and normals

    // Sums of the light of all samples: those on the guide's surface, scattered by diffuse lobes and by others; their
    // divisors, luminances of both signals, their squares; light of samples on another known surface, scattered, and
    // of samples whose surface no nearby guide shows; numbers of the three kinds of samples.
    static constexpr uint32_t kDiffuse = 0, kGloss = kDiffuse + Light::kArrays, kDiffuseShare = kGloss + Light::kArrays,
                              kGlossShare = kDiffuseShare + Color::kArrays, kSignals = kGlossShare + Color::kArrays,
                              kSquares = kSignals + 2 * LightSum::kArrays,
                              kNeighbour = kSquares + 2 * SquareSum::kArrays, kLoose = kNeighbour + Light::kArrays,
                              kOwnCount = kLoose + Light::kArrays, kNeighbourCount = kOwnCount + 1,
                              kLooseCount = kNeighbourCount + 1;
    // Sums of the features of samples after the first ones, as in PictureSums.
    static constexpr uint32_t kFeatures = kLooseCount + 1, // their number
        kNormal = kFeatures + 1, kNormalCount = kNormal + Color::kArrays, kEmission = kNormalCount + 1,
                              kLooseFeatures = kEmission + Light::kArrays, kDiffuseColor = kLooseFeatures + 1,
                              kGlossColor = kDiffuseColor + Color::kArrays, kSlots = kGlossColor + Color::kArrays;
    // Within kSlots, for each other surface of a pixel.
    static constexpr uint32_t kSlotDiffuse = 0, kSlotGloss = Color::kArrays, kSlotCount = 2 * Color::kArrays,
                              kOfSlot = kSlotCount + 1;
    // For each branch of mirrors: light from the chain's end, luminance of its signal, square of that.
    static constexpr uint32_t kMirrors = kSlots + kNeighbourSurfaces * kOfSlot, kMirrorSignal = Light::kArrays,
                              kMirrorSquare = kMirrorSignal + LightSum::kArrays,
                              kOfMirror = kMirrorSquare + SquareSum::kArrays, kMirrorBranches = 2;
    static constexpr uint32_t kArrays = kMirrors + kMirrorBranches * kOfMirror;
};

/// Sums of a picture's samples. The light of a pixel is that of its samples over the sum of their divisors, not the
/// mean of their signals, so that light which a normal map concentrates on the bright parts of a texture is preserved.
struct PictureSums {
    // Sums of light on the guide's surface, which FinishSums makes of the exact ones.
    Float4* diffuse;       // rgb scattered by diffuse lobes; number of samples
    Float4* gloss;         // rgb, scattered by other lobes
    Float4* diffuse_share; // rgb of divisors of these samples; luminances of the signal
    Float4* gloss_share;   // divisors of these samples for the gloss signal
    Vec2* squares;         // squares of these luminances

    // Sums of the features of the first samples, which every part of a picture has. They decide which surfaces a pixel
    // distinguishes, so that what a sample adds depends on no other sample.
    Float4* normal;                                // normal of the guide's surface; their number
    Float4* emission;                              // rgb of emission; number of loose samples
    Float4* diffuse_color;                         // rgb of divisors of the guide's surface
    Float4* gloss_color;                           // divisors of the guide's surface for the gloss signal
    Float4* neighbour_diffuse[kNeighbourSurfaces]; // divisors of another surface; bits of a pixel whose guide shows it,
                                                   // kNoHit: none
    Float4* neighbour_gloss[kNeighbourSurfaces];   // for the other signal; their number

    ExactSums exact; // SampleSums

    // Features of all samples; w is their number, if there is one.

    HD Float4 all_normal(uint32_t pixel) const {
        return all<SampleSums::Color>(normal[pixel], SampleSums::kNormal, SampleSums::kNormalCount, pixel);
    }
    HD Float4 all_emission(uint32_t pixel) const {
        return all<SampleSums::Light>(emission[pixel], SampleSums::kEmission, SampleSums::kLooseFeatures, pixel);
    }
    HD Rgb all_diffuse_color(uint32_t pixel) const {
        return SampleSums::Color::plus(rgb_of(diffuse_color[pixel]), exact, SampleSums::kDiffuseColor, pixel);
    }
    HD Rgb all_gloss_color(uint32_t pixel) const {
        return SampleSums::Color::plus(rgb_of(gloss_color[pixel]), exact, SampleSums::kGlossColor, pixel);
    }
    HD Rgb all_neighbour_diffuse(int slot, uint32_t pixel) const {
        return SampleSums::Color::plus(rgb_of(neighbour_diffuse[slot][pixel]), exact,
                                       of_slot(slot) + SampleSums::kSlotDiffuse, pixel);
    }
    HD Float4 all_neighbour_gloss(int slot, uint32_t pixel) const {
        return all<SampleSums::Color>(neighbour_gloss[slot][pixel], of_slot(slot) + SampleSums::kSlotGloss,
                                      of_slot(slot) + SampleSums::kSlotCount, pixel);
    }
    /// Number of camera rays in the sums of features, of which `first` are those of the first samples.
    HD float features(float first, uint32_t pixel) const {
        return first + static_cast<float>(exact.at(SampleSums::kFeatures, pixel));
    }
    /// Light of samples on another known surface; their number.
    HD Float4 neighbour(uint32_t pixel) const {
        return all<SampleSums::Light>({0, 0, 0, 0}, SampleSums::kNeighbour, SampleSums::kNeighbourCount, pixel);
    }
    /// Light of samples whose surface no nearby guide shows; their number.
    HD Float4 loose(uint32_t pixel) const {
        return all<SampleSums::Light>({0, 0, 0, 0}, SampleSums::kLoose, SampleSums::kLooseCount, pixel);
    }
    HD static constexpr uint32_t of_slot(int slot) {
        return SampleSums::kSlots + static_cast<uint32_t>(slot) * SampleSums::kOfSlot;
    }
    HD static constexpr uint32_t of_branch(int branch) {
        return SampleSums::kMirrors + static_cast<uint32_t>(branch) * SampleSums::kOfMirror;
    }

private:
    template <class Sums>
    HD Float4 all(Float4 first, uint32_t array, uint32_t count, uint32_t pixel) const {
        return with_w(Sums::plus(rgb_of(first), exact, array, pixel),
                      first.w + static_cast<float>(exact.at(count, pixel)));
    }
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
