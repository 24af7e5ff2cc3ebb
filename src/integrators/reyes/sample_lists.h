#pragma once

// Where the samples of a pass lie: each pixel has its own places, drawn as for rays of the camera, and each place is on
// the list of the cell of one pixel that it lies in, which may not be its own where the filter is wide. So a
// micropolygon looks at the samples near it alone.
//
// Source: Cook, "Stochastic Sampling in Computer Graphics", ACM TOG 5(1), 1986, for samples that are jittered.

#include "device/atomic_exchange.h"
#include "integrators/reyes/reyes_settings.h"
#include "render/picture_view.h"
#include "render/raster/scan_row.h"

namespace pertev {

inline constexpr uint32_t kNoSample = ~uint32_t(0);
inline constexpr uint64_t kNothingThere = ~uint64_t(0);

/// Arrays of one pass; sample s of pixel p stands at s * pixels + p.
struct SampleLists {
    SamplePlace* places; // 1/256 pixels from the picture's upper left corner
    uint64_t* nearest;   // (bits of the depth, triangle) of what is nearest, or kNothingThere
    uint64_t* ways;      // of which micropolygon of that triangle (Piece::way)
    uint32_t* next;      // on the list, or kNoSample
    uint32_t* heads;     // [pixels] of each cell's list
    float* far;          // [pixels] that no sample on the list shows anything beyond, when FindFar last looked
    uint32_t width, height;
    uint32_t first, count; // samples of each pixel in this pass

    /// The cell of a place; what lies outside of the picture belongs to the cells at its edge.
    HD int32_t column_of(int32_t x) const {
        return clamp(static_cast<int32_t>(floor_divide(x, kSubpixels)), 0, static_cast<int32_t>(width) - 1);
    }
    HD int32_t row_of(int32_t y) const {
        return clamp(static_cast<int32_t>(floor_divide(y, kSubpixels)), 0, static_cast<int32_t>(height) - 1);
    }
    HD uint32_t head(int32_t column, int32_t row) const {
        return heads[static_cast<uint32_t>(row) * width + static_cast<uint32_t>(column)];
    }
    HD float far_of(int32_t column, int32_t row) const {
        return far[static_cast<uint32_t>(row) * width + static_cast<uint32_t>(column)];
    }
    HD uint32_t pixels() const { return width * height; }
};

/// Sample i of a pass finds its place.
struct PlaceSamples {
    CameraRays camera;
    SamplerKind sampler;
    uint32_t seed;
    SampleLists samples;

    HD void operator()(uint32_t i) const {
        const uint32_t pixels = samples.pixels(), pixel = i % pixels;
        const SampleKey key = {pixel, samples.first + i / pixels, seed};
        const Vec2 offset = sample_filter(camera.filter, sample_2d(sampler, key, kGroupCamera));
        const auto place = [](uint32_t at, float off) {
            const float rounded = floor((0.5f + off) * static_cast<float>(kSubpixels) + 0.5f);
            return static_cast<int32_t>(at) * kSubpixels + to_int(rounded, -(1 << 24), 1 << 24);
        };
        const SamplePlace at = {place(pixel % samples.width, offset.x), place(pixel / samples.width, offset.y)};
        samples.places[i] = at;
        uint32_t* head = samples.heads + static_cast<uint32_t>(samples.row_of(at.y)) * samples.width +
                         static_cast<uint32_t>(samples.column_of(at.x));
        samples.next[i] = atomic_exchange(head, i); // in any order, which nothing shows
    }
};

/// How far away the samples on the list of cell i are by now: what lies beyond is hidden, whatever comes later.
struct FindFar {
    SampleLists samples;

    HD void operator()(uint32_t cell) const {
        float far = 0;
        for (uint32_t i = samples.heads[cell]; i != kNoSample; i = samples.next[i]) {
            const uint64_t nearest = samples.nearest[i];
            far = nearest == kNothingThere ? kInfinity : max(far, float_of(static_cast<uint32_t>(nearest >> 32)));
            if (far == kInfinity) break;
        }
        samples.far[cell] = far;
    }
};

} // namespace pertev
