#pragma once

// Pixel reconstruction filters by importance sampling: a sample falls at a distance from the pixel's centre that is
// drawn from the filter, and counts for that pixel alone with weight 1, so no filter makes fringes or needs splats.
//
// Source: Ernst, Stamminger, Greiner, "Filter Importance Sampling", RT 2006. All filters are separable and positive.

#include <cstdint>
#include <vector>

#include "base/host_device.h"
#include "math/sampling.h"
#include "math/scalar.h"
#include "math/vec2.h"

namespace pertev {

enum class PixelFilter : uint8_t { Box, Tent, Gaussian, BlackmanHarris };

/// Half the width of a filter's support where the user names none, pixels.
float default_filter_radius(PixelFilter filter);

inline constexpr int kFilterTableSize = 256;

struct PixelFilterView {
    PixelFilter kind;
    float radius;       // pixels
    const float* table; // [kFilterTableSize + 1], of make_filter_table; table kinds only
};

/// Inverse of the cumulative distribution along one axis, in radii; empty for Box and Tent, which have closed forms.
/// Entry i stands at the cumulative probability that a tent has reached at 2 i / kFilterTableSize - 1 of its radius:
/// the inverse is steep where a filter fades out, and that puts the entries close together there. Gaussian: standard
/// deviation radius / 3 (cut at 3 sigma). Blackman-Harris: the 4-term window over [-radius, radius].
std::vector<float> make_filter_table(PixelFilter filter);

/// Offset from the pixel's centre along one axis, pixels. u in (0, 1).
HD inline float sample_filter_axis(const PixelFilterView& filter, float u) {
    switch (filter.kind) {
    case PixelFilter::Box:
        return filter.radius * (2.0f * u - 1.0f);
    case PixelFilter::Tent:
        return filter.radius * sample_tent(u);
    case PixelFilter::Gaussian:
    case PixelFilter::BlackmanHarris:
        break;
    }
    const float x = (0.5f + 0.5f * sample_tent(u)) * static_cast<float>(kFilterTableSize);
    const int i = to_int(x, 0, kFilterTableSize - 1);
    return filter.radius * lerp(filter.table[i], filter.table[i + 1], x - static_cast<float>(i));
}

HD inline Vec2 sample_filter(const PixelFilterView& filter, Vec2 u) {
    return {sample_filter_axis(filter, u.x), sample_filter_axis(filter, u.y)};
}

} // namespace pertev
