#pragma once

// Scan conversion in exact integers: a sample belongs to a triangle if it lies on the inner side of all three edges,
// or on a left or upper edge. Thus exactly one of the triangles that share an edge has each sample, and a closed mesh
// has neither gaps nor duplicate samples. The first and last pixel of a row are computed by division.
//
// Source: Pineda, "A Parallel Algorithm for Polygon Rasterization", SIGGRAPH 1988, for the edge functions.

#include "render/raster/project_triangle.h"

namespace pertev {

/// Position of the sample in every pixel, in 1/256 pixels from its upper left corner; the filter may move it outside.
struct SamplePosition {
    int32_t x, y;
};

struct PixelSpan {
    int32_t first, last; // inclusive; empty if last < first
};

HD inline int64_t floor_divide(int64_t a, int64_t b) { // b > 0
    const int64_t q = a / b;
    return q * b > a ? q - 1 : q;
}

/// Lower bound on the number of columns between a triangle's first and last corner.
HD inline int32_t columns_of(const ProjectedTriangle& t) {
    int32_t left = t.x[0], right = t.x[0];
    for (int i = 1; i < t.count; ++i) left = min(left, t.x[i]), right = max(right, t.x[i]);
    return (right - left) / kSubpixels;
}

/// Rows whose samples may lie in the polygon.
HD inline PixelSpan rows_of(const ProjectedTriangle& t, SamplePosition position, uint32_t height) {
    int32_t top = t.y[0], bottom = t.y[0];
    for (int i = 1; i < t.count; ++i) top = min(top, t.y[i]), bottom = max(bottom, t.y[i]);
    const auto row = [&](int32_t y) { return static_cast<int32_t>(floor_divide(y - position.y, kSubpixels)); };
    return {max(row(top - 1) + 1, 0), min(row(bottom), static_cast<int32_t>(height) - 1)};
}

/// The triangle of corners 0, k and k + 1, oriented so that its area is positive.
struct WoundTriangle {
    int64_t x[3], y[3];

    /// Sets the triangle. Returns false if it has no area.
    HD bool begin(const ProjectedTriangle& t, int k) {
        x[0] = t.x[0], x[1] = t.x[k], x[2] = t.x[k + 1];
        y[0] = t.y[0], y[1] = t.y[k], y[2] = t.y[k + 1];
        const int64_t area = (x[1] - x[0]) * (y[2] - y[0]) - (y[1] - y[0]) * (x[2] - x[0]);
        if (area < 0) { // reverses the orientation
            const int64_t column = x[1], row = y[1];
            x[1] = x[2], y[1] = y[2];
            x[2] = column, y[2] = row;
        }
        return area != 0;
    }
};

/// Returns whether a triangle owns the samples on an edge in direction (dx, dy): a left edge or an upper one.
HD inline bool has_edge(int64_t dx, int64_t dy) { return dy < 0 || (dy == 0 && dx > 0); }

/// Pixels of row `y` whose samples lie in the triangle of corners 0, k and k + 1.
HD inline PixelSpan span_of(const ProjectedTriangle& t, int k, int32_t y, SamplePosition position, uint32_t width) {
    PixelSpan span = {0, -1};
    WoundTriangle wound;
    if (!wound.begin(t, k)) return span;
    int64_t first = 0, last = static_cast<int64_t>(width) - 1;
    const int64_t at_y = int64_t(y) * kSubpixels + position.y;
    for (int i = 0; i < 3; ++i) {
        const int64_t x0 = wound.x[i], y0 = wound.y[i], dx = wound.x[(i + 1) % 3] - x0, dy = wound.y[(i + 1) % 3] - y0;
        // Inside: at - 256 dy pixel >= 0.
        const int64_t at = dx * (at_y - y0) + dy * (x0 - position.x) - (has_edge(dx, dy) ? 0 : 1);
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

/// Returns whether the polygon contains the single sample at `at`, from the picture's upper left corner; consistent
/// with span_of.
HD inline bool has_sample(const ProjectedTriangle& t, SamplePosition at) {
    for (int k = 1; k + 1 < t.count; ++k) {
        WoundTriangle wound;
        if (!wound.begin(t, k)) continue;
        bool is_inside = true;
        for (int i = 0; i < 3; ++i) {
            const int64_t dx = wound.x[(i + 1) % 3] - wound.x[i], dy = wound.y[(i + 1) % 3] - wound.y[i];
            const int64_t side = dx * (at.y - wound.y[i]) - dy * (at.x - wound.x[i]);
            is_inside = is_inside && side >= (has_edge(dx, dy) ? 0 : 1);
        }
        if (is_inside) return true;
    }
    return false;
}

} // namespace pertev
