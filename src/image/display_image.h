#pragma once

// Linear pictures for a display, in 8 or 16 bits: exposure, tone map, and a look-up table after it or in its place.

#include <memory>

#include "image/cube_lut.h"
#include "image/image.h"
#include "image/rgba16_image.h"
#include "image/tone_map.h"

namespace pertev {

/// The place of a look-up table.
enum class LutInput : uint8_t {
    Display, // it changes what the tone map has made
    Light,   // it replaces the tone map, and gets linear light times the exposure
};

struct DisplayTransform {
    ToneMap tone_map = ToneMap::Srgb;
    float exposure_stops = 0;
    std::shared_ptr<const CubeLut> lut = {}; // null: none
    LutInput lut_input = LutInput::Display;
};

/// Returns the picture for a display. Alpha is treated as tone_map_image does, which this is without a table.
Rgba8Image display_image(const Image& linear, const DisplayTransform& transform, bool keep_alpha = true);
/// Returns the picture of display_image() with 16 bits a channel.
Rgba16Image display_image_16(const Image& linear, const DisplayTransform& transform, bool keep_alpha = true);

} // namespace pertev
