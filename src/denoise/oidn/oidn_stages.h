#pragma once

// Stages that make what Open Image Denoise reads, and that read what it made.

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

/// Exact sums of guides over samples, from which their order leaves no trace.
struct OidnSums {
    static constexpr uint32_t kArrays = 7; // albedo, normal, number of samples
    static constexpr double kUnit = 0x1p-38;

    int64_t* numbers; // one array after the other, in units of kUnit
    uint32_t pixels;

    HD int64_t& at(uint32_t array, uint32_t pixel) const { return numbers[std::size_t(array) * pixels + pixel]; }
};

/// The stage that adds a sample to sums of guides.
struct AddOidnGuides {
    NoisyFrameView frame;
    OidnSums sums;

    HD void operator()(uint32_t pixel) const {
        const OidnGuide guide = oidn_guide(frame, pixel);
        add(0, pixel, guide.albedo);
        add(3, pixel, guide.normal);
        sums.at(6, pixel) += 1;
    }

private:
    static constexpr float kMost = 2; // times kMaxSamplesPerPixel it fits 64 bits

    HD void add(uint32_t array, uint32_t pixel, Float4 guide) const {
        const float values[] = {guide.x, guide.y, guide.z};
        for (uint32_t i = 0; i < 3; ++i) {
            sums.at(array + i, pixel) += static_cast<int64_t>(clamp(values[i], -kMost, kMost) * 0x1p38f);
        }
    }
};

/// The stage that makes the guides' means of all samples: of `first` ones, whose means are there, and of the sums.
struct FinishOidnGuides {
    const Float4 *first_albedo, *first_normal;
    double first;
    OidnSums sums;
    Float4 *albedo, *normal;

    HD void operator()(uint32_t pixel) const {
        albedo[pixel] = mean(first_albedo[pixel], 0, pixel);
        normal[pixel] = mean(first_normal[pixel], 3, pixel);
    }

private:
    HD Float4 mean(Float4 of_first, uint32_t array, uint32_t pixel) const {
        const int64_t more = sums.at(6, pixel);
        if (more == 0) return of_first;
        const double share = 1.0 / (first + static_cast<double>(more));
        return {mean(of_first.x, sums.at(array, pixel), share), mean(of_first.y, sums.at(array + 1, pixel), share),
                mean(of_first.z, sums.at(array + 2, pixel), share), 0};
    }
    HD float mean(float of_first, int64_t sum, double share) const {
        return static_cast<float>((first * static_cast<double>(of_first) + static_cast<double>(sum) * OidnSums::kUnit) *
                                  share);
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
