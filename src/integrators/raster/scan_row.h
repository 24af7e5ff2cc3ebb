#pragma once

// Scan conversion by exact integers: a sample belongs to a triangle where it lies on the inner side of all three edges,
// or on an edge that is a left or an upper one. So of triangles that share an edge just one has each sample, and a
// closed mesh has neither gaps nor samples drawn twice. Of a row of pixels the first and the last are divided out.
//
// Source: Pineda, "A Parallel Algorithm for Polygon Rasterization", SIGGRAPH 1988, for the edge functions.

#include "integrators/raster/project_triangle.h"

namespace pertev {

/// Where in every pixel a sample lies, 1/256 pixels from the pixel's upper left corner; outside of it by the filter.
struct SamplePlace {
    int32_t x, y;
};

struct PixelSpan {
    int32_t first, last; // inclusive; none where last < first
};

HD inline int64_t floor_divide(int64_t a, int64_t b) { // b > 0
    const int64_t q = a / b;
    return q * b > a ? q - 1 : q;
}

/// Columns between its first and its last corner, at least.
HD inline int32_t columns_of(const ProjectedTriangle& t) {
    int32_t left = t.x[0], right = t.x[0];
    for (int i = 1; i < t.count; ++i) left = min(left, t.x[i]), right = max(right, t.x[i]);
    return (right - left) / kSubpixels;
}

/// Rows whose samples may lie in the polygon.
HD inline PixelSpan rows_of(const ProjectedTriangle& t, SamplePlace place, uint32_t height) {
    int32_t top = t.y[0], bottom = t.y[0];
    for (int i = 1; i < t.count; ++i) top = min(top, t.y[i]), bottom = max(bottom, t.y[i]);
    const auto row = [&](int32_t y) { return static_cast<int32_t>(floor_divide(y - place.y, kSubpixels)); };
    return {max(row(top - 1) + 1, 0), min(row(bottom), static_cast<int32_t>(height) - 1)};
}

/// Pixels of row `y` whose samples lie in the triangle of corners 0, k and k + 1.
HD inline PixelSpan span_of(const ProjectedTriangle& t, int k, int32_t y, SamplePlace place, uint32_t width) {
    int64_t px[3] = {t.x[0], t.x[k], t.x[k + 1]}, py[3] = {t.y[0], t.y[k], t.y[k + 1]};
    const int64_t area = (px[1] - px[0]) * (py[2] - py[0]) - (py[1] - py[0]) * (px[2] - px[0]);
    PixelSpan span = {0, -1};
    if (area == 0) return span;
    if (area < 0) { // the other way round
        const int64_t x = px[1], row = py[1];
        px[1] = px[2], py[1] = py[2];
        px[2] = x, py[2] = row;
    }
    int64_t first = 0, last = static_cast<int64_t>(width) - 1;
    const int64_t at_y = int64_t(y) * kSubpixels + place.y;
    for (int i = 0; i < 3; ++i) {
        const int64_t x0 = px[i], y0 = py[i], dx = px[(i + 1) % 3] - x0, dy = py[(i + 1) % 3] - y0;
        const bool has_edge = dy < 0 || (dy == 0 && dx > 0); // left, or upper
        // Inside: at - 256 dy pixel >= 0.
        const int64_t at = dx * (at_y - y0) + dy * (x0 - place.x) - (has_edge ? 0 : 1);
        if (dy > 0) {
            last = min(last, floor_divide(at, kSubpixels * dy));
        } else if (dy < 0) {
            first = max(first, -floor_divide(at, -kSubpixels * dy));
        } else if (at < 0) {
            return span;
        }
    }
    span.first = static_cast<int32_t>(min(first, int64_t(width)));
    span.last = static_cast<int32_t>(max(last, int64_t(-1)));
    return span;
}

} // namespace pertev
