#pragma once

// A band of rows of a picture, for stages that run for a part of it. A stage with one call per pixel is launched by
// launch_in_band(); one that takes pixels in tiles finds them by tiled_in_band().

#include <algorithm>
#include <cstdint>

#include "base/host_device.h"
#include "device/launch.h"
#include "render/tiled_pixel.h"

namespace pertev {

/// Rows [first, end).
struct RowBand {
    uint32_t first = 0, end = 0;

    bool operator==(const RowBand&) const = default;
    HD uint32_t count() const { return end - first; }
    bool is_empty() const { return end == first; }
    /// Returns the band with `rows` more rows on either side, within a picture of `height` rows. An empty band stays
    /// empty.
    RowBand grown(uint32_t rows, uint32_t height) const {
        if (is_empty()) return *this;
        return {first - std::min(first, rows), end + std::min(height - end, rows)};
    }
};

/// The rows that both have.
inline RowBand common_rows(RowBand a, RowBand b) {
    const uint32_t first = std::max(a.first, b.first), end = std::min(a.end, b.end);
    return first < end ? RowBand{first, end} : RowBand{};
}

/// The position of the pixel with index `i` of the band's tiles (tiled_position).
HD inline PixelPosition tiled_in_band(uint32_t i, uint32_t width, RowBand rows) {
    const PixelPosition at = tiled_position(i, width, rows.count());
    return {at.x, rows.first + at.y};
}

/// Runs a stage for the pixels from `first` on.
template <class Stage>
struct FromPixel {
    Stage stage; // is called once per pixel
    uint32_t first;

    HD void operator()(uint32_t i) const { stage(first + i); }
};

/// Launches a stage with one call per pixel for the rows of a picture that is `width` pixels wide.
template <class Stage>
void launch_in_band(Queue& queue, const char* name, RowBand rows, uint32_t width, const Stage& stage) {
    launch(queue, name, rows.count() * width, FromPixel<Stage>{stage, rows.first * width});
}

} // namespace pertev
