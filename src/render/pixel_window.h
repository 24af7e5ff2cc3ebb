#pragma once

// Three numbers name a pixel. The *pixel* is its index in the whole picture, row by row: the camera ray depends on it.
// The *key* of its random numbers (SampleKey, math/sampler.h) depends on the pixel, too. The *slot* is its place in a
// film, which holds a window of the picture. Only this file relates slots to pixels, so a window has the bytes of the
// whole picture there.

#include <array>
#include <cstdint>

#include "base/host_device.h"

namespace pertev {

/// Index of a pixel in a film, row by row.
enum class FilmSlot : uint32_t {};

struct PixelWindow {
    uint32_t picture_width = 0;     // pixels; 0 if the window is the whole picture
    uint32_t x = 0, y = 0;          // upper left pixel
    uint32_t width = 0, height = 0; // pixels

    bool operator==(const PixelWindow&) const = default;

    /// Returns whether the window lies in a picture of this size.
    bool is_in(uint32_t picture_w, uint32_t picture_h) const {
        if (picture_width == 0) return width == picture_w && height == picture_h;
        return picture_width == picture_w && uint64_t(x) + width <= picture_w && uint64_t(y) + height <= picture_h;
    }
    HD uint32_t count() const { return width * height; }
    HD uint32_t pixel_at(FilmSlot of) const {
        const auto slot = static_cast<uint32_t>(of);
        return picture_width == 0 ? slot : (y + slot / width) * picture_width + x + slot % width;
    }
    /// Slot of `pixel`, which must lie in the window.
    HD FilmSlot slot_of(uint32_t pixel) const {
        return FilmSlot{picture_width == 0 ? pixel : (pixel / picture_width - y) * width + pixel % picture_width - x};
    }
    /// The pixel at this column and row of the picture.
    HD uint32_t pixel_in(uint32_t column, uint32_t row) const {
        return row * (picture_width == 0 ? width : picture_width) + column;
    }
};

/// Runs a stage for the pixels of a window: one call per slot.
template <class Stage>
struct InWindow {
    Stage stage; // is called once per pixel
    PixelWindow window;

    HD void operator()(uint32_t slot) const { stage(window.pixel_at(FilmSlot{slot})); }
};

/// The rest of a picture of `height` rows around `window`: above, below, left and right. All are empty if the window
/// is the whole picture.
inline std::array<PixelWindow, 4> windows_around(const PixelWindow& window, uint32_t height) {
    const uint32_t width = window.picture_width, end_x = window.x + window.width, end_y = window.y + window.height;
    if (width == 0) return {};
    return {{{width, 0, 0, width, window.y},
             {width, 0, end_y, width, height - end_y},
             {width, 0, window.y, window.x, window.height},
             {width, end_x, window.y, width - end_x, window.height}}};
}

} // namespace pertev
