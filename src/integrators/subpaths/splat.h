#pragma once

// Adds what a particle brings to the picture. The camera's rays of a pixel are drawn from the pixel filter about its
// centre (render/pixel_filter.h), so the pixel's value is a mean over the filter's density; what a particle brings to
// a place of the picture therefore counts for each pixel about it times that very density, in 1/pixel^2. By integers,
// whose sums do not depend on their order.

#include "render/film_view.h"
#include "render/pixel_filter.h"

namespace pertev {

/// Density, 1/pixel, with which sample_filter_axis gives `x`, pixels from the pixel's centre.
HD inline float filter_density(const PixelFilterView& filter, float x) {
    const float at = x / filter.radius;
    if (!(abs(at) < 1)) return 0;
    switch (filter.kind) {
    case PixelFilter::Box:
        return 0.5f / filter.radius;
    case PixelFilter::Tent:
        return pdf_tent(at) / filter.radius;
    case PixelFilter::Gaussian:
    case PixelFilter::BlackmanHarris:
        break;
    }
    int low = 0, high = kFilterTableSize; // table[low] <= at < table[high]
    while (high - low > 1) {
        const int middle = (low + high) / 2;
        (filter.table[middle] <= at ? low : high) = middle;
    }
    const float width = filter.table[high] - filter.table[low];
    if (!(width > 0)) return 0;
    const float part = 1.0f / static_cast<float>(kFilterTableSize);
    const float u = (static_cast<float>(low) + (at - filter.table[low]) / width) * part;
    return pdf_tent(2.0f * u - 1.0f) * (2.0f * part) / (width * filter.radius);
}

/// `light` at `raster`, in pixels from the upper left corner.
HD inline void add_splat(const FilmView& film, const PixelFilterView& filter, Vec2 raster, Rgb light) {
    constexpr int kFar = 1 << 30;
    const float left = raster.x - 0.5f - filter.radius, top = raster.y - 0.5f - filter.radius;
    const int first_x = to_int(floor(left) + 1.0f, 0, kFar), first_y = to_int(floor(top) + 1.0f, 0, kFar);
    const int last_x = to_int(raster.x - 0.5f + filter.radius, 0, static_cast<int>(film.width) - 1);
    const int last_y = to_int(raster.y - 0.5f + filter.radius, 0, static_cast<int>(film.height) - 1);
    for (int y = first_y; y <= last_y; ++y) {
        const float row = filter_density(filter, raster.y - 0.5f - static_cast<float>(y));
        if (!(row > 0)) continue;
        for (int x = first_x; x <= last_x; ++x) {
            const float share = row * filter_density(filter, raster.x - 0.5f - static_cast<float>(x));
            if (!(share > 0)) continue;
            add_radiance(film, static_cast<uint32_t>(y) * film.width + static_cast<uint32_t>(x), share * light);
        }
    }
}

} // namespace pertev
