#pragma once

// Pixel reconstruction filters by importance sampling: the offset of a sample from the pixel's centre is drawn from
// the filter, and the sample counts only for that pixel, with weight 1. Thus no filter causes ringing or needs
// splatting.
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

/// Default half width of a filter's support, in pixels.
float default_filter_radius(PixelFilter filter);

inline constexpr int kFilterTableSize = 256;

struct PixelFilterView {
    PixelFilter kind;
    float radius;       // pixels
    const float* table; // [kFilterTableSize + 1], from make_filter_table; only for filters with a table
};

/// Inverse of the cumulative distribution along one axis, in units of the radius; empty for Box and Tent, which have
/// closed forms. Entry i belongs to the cumulative probability that a tent reaches at 2 i / kFilterTableSize - 1 of
/// its radius. This places the entries densely where the filter fades out and the inverse is steep. Gaussian:
/// standard deviation radius / 3 (cut at 3 sigma). Blackman-Harris: the 4-term window over [-radius, radius].
std::vector<float> make_filter_table(PixelFilter filter);

/// Offset from the pixel's centre along one axis, in pixels. u in (0, 1).
template <class T = float>
HD inline T sample_filter_axis(const PixelFilterView& filter, T u) {
    switch (filter.kind) {
    case PixelFilter::Box:
        return filter.radius * (2.0f * u - 1.0f);
    case PixelFilter::Tent:
        return filter.radius * sample_tent(u);
    case PixelFilter::Gaussian:
    case PixelFilter::BlackmanHarris:
        break;
    }
    const T x = (0.5f + 0.5f * sample_tent(u)) * static_cast<float>(kFilterTableSize);
    const T i = floor(clamp(x, T(0.0f), T(static_cast<float>(kFilterTableSize - 1))));
    const WordOf<T> at = truncate_to_word(i);
    return filter.radius * lerp(gather<T>(filter.table, at), gather<T>(filter.table + 1, at), x - i);
}

template <class T = float>
HD inline Vec2Of<T> sample_filter(const PixelFilterView& filter, Vec2Of<T> u) {
    return {sample_filter_axis(filter, u.x), sample_filter_axis(filter, u.y)};
}

} // namespace pertev
