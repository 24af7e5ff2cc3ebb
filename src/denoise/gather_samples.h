#pragma once

// First stages of a single picture: guides, and sums over samples.

#include "denoise/mirror_sums.h"
#include "denoise/reproject.h"
#include "denoise/split_light.h"
#include "render/film_view.h"
#include "shading/shading_frame.h"

namespace pertev {

/// The stage that copies the guides from a frame of rays through pixels' centres, and clears the sums of features.
struct BeginSums {
    GBufferView centres;
    PictureGuide guide;
    PictureSums sums;

    HD void operator()(uint32_t pixel) const {
        guide.normal[pixel] = centres.normal[pixel];
        guide.albedo[pixel] = centres.albedo[pixel];
        guide.object[pixel] = bits_of(centres.hit[pixel].x);
        constexpr Float4 kZero = {0, 0, 0, 0};
        sums.normal[pixel] = sums.emission[pixel] = sums.diffuse_color[pixel] = sums.gloss_color[pixel] = kZero;
        for (int slot = 0; slot < kNeighbourSurfaces; ++slot) {
            sums.neighbour_diffuse[slot][pixel] = {0, 0, 0, float_of(kNoHit)};
            sums.neighbour_gloss[slot][pixel] = kZero;
        }
    }
};

/// The stage that makes the guides' normals for the filter: means over the pixel, like its light. The unsmoothed guides
/// are kept for more samples.
struct SmoothGuide {
    PictureGuide guide;
    PictureSums sums;
    Float4* smooth; // normal of PictureGuide
    Float4* packed; // packed Guide for the filter

    HD void operator()(uint32_t pixel) const {
        const Float4 own = guide.normal[pixel];
        const Vec3 mean = normalize_or(vec3_of(sums.all_normal(pixel)), vec3_of(own));
        smooth[pixel] = {mean.x, mean.y, mean.z, own.w};
        packed[pixel] = pack({mean, guide.albedo[pixel].w, own.w, guide.object[pixel]});
    }
};

/// A frame's samples, with the search for the surfaces that they hit.
struct SampledSurfaces {
    NoisyFrameView frame;
    PictureGuide guide;
    PictureSums sums;
    const InstanceView* instances;
    const MeshView* meshes;
    CameraView camera;
    uint32_t width, height;

    struct Found {
        uint32_t object; // kNoHit: no hit
        Vec3 point;      // camera space, as a straight lens would show it there
        Vec3 normal;
    };
    HD Found found(uint32_t pixel) const {
        const Float4 hit = frame.hit[pixel];
        Found f = {bits_of(hit.x), {}, vec3_of(frame.normal[pixel])};
        if (f.object == kNoHit) return f;
        const Vec3 point = point_at(instances, meshes, hit);
        f.point = transform_transposed(camera.world_from_camera, point - camera.world_from_camera.translation);
        if (!camera.lens.is_straight()) { // guides lie where a straight lens shows their pixels
            const LensProjection through = project_through_lens(camera.lens, f.point);
            f.point = {-f.point.z * through.at.x, -f.point.z * through.at.y, f.point.z};
        }
        return f;
    }
    /// Returns whether the sample's own pixel shows the sample's surface, regardless of bumps.
    HD bool shows_own(uint32_t pixel, const Found& f) const {
        return shows_surface(guide, camera, width, pixel, f.object, f.point, f.normal, 0.5f);
    }
    HD bool shows(uint32_t pixel, const Found& f) const {
        return shows_surface(guide, camera, width, pixel, f.object, f.point, f.normal, 0.8f);
    }
    /// Slot of the surface of `f` among the additional ones of the pixel; kNeighbourSurfaces if it has none and all are
    /// taken. `is_free` means that the slot has no surface yet.
    HD int slot_of(uint32_t pixel, const Found& f, bool& is_free) const {
        is_free = false;
        for (int slot = 0; slot < kNeighbourSurfaces; ++slot) {
            const uint32_t there = bits_of(sums.neighbour_diffuse[slot][pixel].w);
            is_free = there == kNoHit;
            if (is_free || shows(there, f)) return slot;
        }
        return kNeighbourSurfaces;
    }
    HD static void add(Float4& sum, Rgb value, float w = 0) {
        const bool keeps = w == 0; // bits of a pixel index must not be added to
        sum = {sum.x + value.r, sum.y + value.g, sum.z + value.b, keeps ? sum.w : sum.w + w};
    }
};

/// Step number `k` of 24 to the pixels around one: rings of a square, 8 pixels, then 16.
struct PixelStep {
    int x, y;
};
HD inline PixelStep step_around(int k) {
    const int ring = k < 8 ? 1 : 2, at = k < 8 ? k : k - 8;
    const int side = at / (2 * ring), along = at % (2 * ring) - ring;
    const int dx = side == 0 ? along : side == 1 ? ring : side == 2 ? -along : -ring;
    const int dy = side == 0 ? -ring : side == 1 ? along : side == 2 ? ring : -along;
    return {dx, dy};
}
/// Returns the first pixel around `pixel`, in the order of PixelStep and within the picture, for which `is_wanted` is
/// true; kNoHit: none.
template <class IsWanted>
HD inline uint32_t nearest_around(uint32_t pixel, uint32_t width, uint32_t height, const IsWanted& is_wanted) {
    const int w = static_cast<int>(width), h = static_cast<int>(height);
    const int x = static_cast<int>(pixel % width), y = static_cast<int>(pixel / width);
    for (int k = 0; k < 24; ++k) {
        const PixelStep step = step_around(k);
        if (x + step.x < 0 || y + step.y < 0 || x + step.x >= w || y + step.y >= h) continue;
        const uint32_t there = static_cast<uint32_t>((y + step.y) * w + x + step.x);
        if (is_wanted(there)) return there;
    }
    return kNoHit;
}

/// The stage that sums the hits of a pixel's first camera rays.
struct GatherFeatures {
    SampledSurfaces samples;

    HD void operator()(uint32_t pixel) const {
        const NoisyFrameView& frame = samples.frame;
        const PictureSums& sums = samples.sums;
        // The light may be of the camera ray alone or of the whole sample, and must not matter.
        const Rgb seen = rgb_of(frame.emission[pixel]);
        const bool is_valid = is_valid_sample(seen.r) && is_valid_sample(seen.g) && is_valid_sample(seen.b);
        const Rgb emission = is_valid ? seen : Rgb{0, 0, 0};
        const SampledSurfaces::Found found = samples.found(pixel);
        if (found.object == kNoHit) return SampledSurfaces::add(sums.emission[pixel], emission);
        const Rgb diffuse = diffuse_divisor(frame, pixel), gloss = gloss_divisor(frame, pixel);
        if (samples.shows_own(pixel, found)) {
            SampledSurfaces::add(sums.diffuse_color[pixel], diffuse);
            SampledSurfaces::add(sums.gloss_color[pixel], gloss);
            SampledSurfaces::add(sums.normal[pixel], {found.normal.x, found.normal.y, found.normal.z}, 1);
            return SampledSurfaces::add(sums.emission[pixel], emission);
        }
        bool is_free = false;
        const int slot = samples.slot_of(pixel, found, is_free);
        if (is_free) {
            const uint32_t neighbour = neighbour_pixel(pixel, found);
            if (neighbour != kNoHit) {
                is_free = false;
                sums.neighbour_diffuse[slot][pixel].w = float_of(neighbour);
            }
        }
        if (is_free || slot == kNeighbourSurfaces) return SampledSurfaces::add(sums.emission[pixel], emission, 1);
        SampledSurfaces::add(sums.neighbour_diffuse[slot][pixel], diffuse);
        SampledSurfaces::add(sums.neighbour_gloss[slot][pixel], gloss, 1);
        SampledSurfaces::add(sums.emission[pixel], emission);
    }

private:
    /// The nearest surrounding pixel whose guide shows the surface.
    HD uint32_t neighbour_pixel(uint32_t pixel, const SampledSurfaces::Found& found) const {
        return nearest_around(pixel, samples.width, samples.height,
                              [&](uint32_t there) { return samples.shows(there, found); });
    }
};

/// The stage that sums the light of a sample, and its features if they are not among the first ones. What it adds
/// depends on no other sample but the first ones.
struct GatherLight {
    SampledSurfaces samples;
    MirrorSums mirrors; // may be empty
    bool adds_features;

    HD void operator()(uint32_t pixel) const {
        const NoisyFrameView& frame = samples.frame;
        const PictureSums& sums = samples.sums;
        const ExactSums& exact = sums.exact;
        const Rgb all = frame.light[pixel].w != 0 ? rgb_of(frame.light[pixel]) : Rgb{0, 0, 0},
                  emission = frame.light[pixel].w != 0 ? rgb_of(frame.emission[pixel]) : Rgb{0, 0, 0};
        const auto add_emission = [&] {
            if (adds_features) SampleSums::Light::add(exact, SampleSums::kEmission, pixel, emission);
        };
        if (adds_features) exact.add(SampleSums::kFeatures, pixel, 1);
        const SampledSurfaces::Found found = samples.found(pixel);
        if (found.object == kNoHit) return add_emission();
        if (samples.shows_own(pixel, found)) {
            add_own(pixel, found.normal);
            return add_emission();
        }
        bool is_free = false;
        const int slot = samples.slot_of(pixel, found, is_free);
        if (is_free || slot == kNeighbourSurfaces) {
            SampleSums::Light::add(exact, SampleSums::kLoose, pixel, all - emission);
            exact.add(SampleSums::kLooseCount, pixel, 1);
            if (adds_features) exact.add(SampleSums::kLooseFeatures, pixel, 1);
            return add_emission();
        }
        SampleSums::Light::add(exact, SampleSums::kNeighbour, pixel, all - emission);
        exact.add(SampleSums::kNeighbourCount, pixel, 1);
        if (!adds_features) return;
        const uint32_t array = PictureSums::of_slot(slot);
        SampleSums::Color::add(exact, array + SampleSums::kSlotDiffuse, pixel, diffuse_divisor(frame, pixel));
        SampleSums::Color::add(exact, array + SampleSums::kSlotGloss, pixel, gloss_divisor(frame, pixel));
        exact.add(array + SampleSums::kSlotCount, pixel, 1);
        add_emission();
    }

private:
    /// Adds a sample on the guide's surface.
    HD void add_own(uint32_t pixel, Vec3 normal) const {
        const NoisyFrameView& frame = samples.frame;
        const ExactSums& exact = samples.sums.exact;
        SplitLight light = split_light(frame, pixel);
        light.gloss = take_mirrored(mirrors, exact, frame.mirrors, pixel, light.gloss);
        const float diffuse = luminance(rgb_of(diffuse_signal(light.diffuse, light.diffuse_divisor))),
                    gloss = luminance(light.gloss / light.gloss_divisor);
        exact.add(SampleSums::kOwnCount, pixel, 1);
        SampleSums::Light::add(exact, SampleSums::kDiffuse, pixel, light.diffuse);
        SampleSums::Light::add(exact, SampleSums::kGloss, pixel, light.gloss);
        SampleSums::Color::add(exact, SampleSums::kDiffuseShare, pixel, light.diffuse_divisor);
        SampleSums::Color::add(exact, SampleSums::kGlossShare, pixel, light.gloss_divisor);
        LightSum::add(exact, SampleSums::kSignals, pixel, diffuse);
        LightSum::add(exact, SampleSums::kSignals + LightSum::kArrays, pixel, gloss);
        SquareSum::add(exact, SampleSums::kSquares, pixel, square(diffuse));
        SquareSum::add(exact, SampleSums::kSquares + SquareSum::kArrays, pixel, square(gloss));
        if (!adds_features) return;
        SampleSums::Color::add(exact, SampleSums::kDiffuseColor, pixel, light.diffuse_divisor);
        SampleSums::Color::add(exact, SampleSums::kGlossColor, pixel, light.gloss_divisor);
        SampleSums::Color::add(exact, SampleSums::kNormal, pixel, {normal.x, normal.y, normal.z});
        exact.add(SampleSums::kNormalCount, pixel, 1);
    }
};

} // namespace pertev
