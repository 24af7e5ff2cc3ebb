#pragma once

// Stages that make what Open Image Denoise reads, and that read what it made.

#include "denoise/exact_sums.h"
#include "denoise/shown_color.h"
#include "render/noisy_frame_view.h"
#include "trace/intersect/ray.h"

namespace pertev {

/// Guides of a pixel: colour of what its ray meets, by all lobes, and normal; both are 0 without a hit.
struct OidnGuide {
    Float4 albedo, normal;
};
HD inline OidnGuide oidn_guide(const NoisyFrameView& frame, uint32_t pixel) {
    if (bits_of(frame.hit[pixel].x) == kNoHit) return {};
    const Rgb albedo = rgb_of(frame.albedo[pixel]) + rgb_of(frame.gloss[pixel]);
    const Float4 normal = frame.normal[pixel];
    return {{min(albedo.r, 1.0f), min(albedo.g, 1.0f), min(albedo.b, 1.0f), 0}, {normal.x, normal.y, normal.z, 0}};
}

/// Exact sums of guides over samples, whose order does not affect the result.
struct OidnSums {
    using Guide = SumsOfRgb<SmallSum<1>>;
    static constexpr uint32_t kAlbedo = 0, kNormal = kAlbedo + Guide::kArrays, kCount = kNormal + Guide::kArrays,
                              kArrays = kCount + 1; // the last is the number of samples
};

/// The stage that adds a sample to sums of guides.
struct AddOidnGuides {
    NoisyFrameView frame;
    ExactSums sums;

    HD void operator()(uint32_t pixel) const {
        const OidnGuide guide = oidn_guide(frame, pixel);
        OidnSums::Guide::add(sums, OidnSums::kAlbedo, pixel, rgb_of(guide.albedo));
        OidnSums::Guide::add(sums, OidnSums::kNormal, pixel, rgb_of(guide.normal));
        sums.add(OidnSums::kCount, pixel, 1);
    }
};

/// The stage that makes the guides' means of all samples: of `first` ones, whose means are there, and of the sums.
struct FinishOidnGuides {
    const Float4 *first_albedo, *first_normal;
    double first;
    ExactSums sums;
    Float4 *albedo, *normal;

    HD void operator()(uint32_t pixel) const {
        albedo[pixel] = mean(first_albedo[pixel], OidnSums::kAlbedo, pixel);
        normal[pixel] = mean(first_normal[pixel], OidnSums::kNormal, pixel);
    }

private:
    HD Float4 mean(Float4 of_first, uint32_t array, uint32_t pixel) const {
        const int64_t more = sums.at(OidnSums::kCount, pixel);
        if (more == 0) return of_first;
        const double share = 1.0 / (first + static_cast<double>(more));
        const auto both = [&](float mean, uint32_t k) {
            return static_cast<float>((first * static_cast<double>(mean) + SmallSum<1>::get(sums, array + k, pixel)) *
                                      share);
        };
        return {both(of_first.x, 0), both(of_first.y, 1), both(of_first.z, 2), 0};
    }
};

/// The stage that takes a sample into means of guides: `share` is 1 over the number of samples so far.
struct MeanOidnGuides {
    NoisyFrameView frame;
    Float4 *albedo, *normal;
    float share;

    HD void operator()(uint32_t pixel) const {
        const OidnGuide guide = oidn_guide(frame, pixel);
        albedo[pixel] = share == 1 ? guide.albedo : mean_of(albedo[pixel], guide.albedo);
        normal[pixel] = share == 1 ? guide.normal : mean_of(normal[pixel], guide.normal);
    }

private:
    HD Float4 mean_of(Float4 mean, Float4 next) const {
        return {mean.x + share * (next.x - mean.x), mean.y + share * (next.y - mean.y),
                mean.z + share * (next.z - mean.z), 0};
    }
};

/// The stage that decodes a frame's picture, with the guides of its hits.
struct ReadShownFrame {
    const Float4* shown; // shown_color
    NoisyFrameView frame;
    Float4 *color, *albedo, *normal;

    HD void operator()(uint32_t pixel) const {
        const OidnGuide guide = oidn_guide(frame, pixel);
        albedo[pixel] = guide.albedo;
        normal[pixel] = guide.normal;
        const Rgb light = light_of_shown(rgb_of(shown[pixel]));
        color[pixel] = {light.r, light.g, light.b, 0};
    }
};

/// The stage that encodes a denoised frame again.
struct ShowColor {
    Float4* color;

    HD void operator()(uint32_t pixel) const {
        const Rgb c = rgb_of(color[pixel]);
        color[pixel] = with_w(shown_color({max(c.r, 0.0f), max(c.g, 0.0f), max(c.b, 0.0f)}), 0);
    }
};

} // namespace pertev
