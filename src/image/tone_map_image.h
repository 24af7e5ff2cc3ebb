#pragma once

// Converts a linear picture to 8-bit sRGB, for PNG, JPEG and viewers.

#include "base/value_names.h"
#include "image/image.h"
#include "image/tone_map.h"

namespace pertev {

/// Multiplies `linear` by 2^exposure_stops, tone-maps it and rounds it to the nearest byte. One or two channels are
/// grey; alpha is the second or fourth channel, clamped, not tone-mapped, and 255 if absent. Colour with alpha is
/// premultiplied, as in EXR, and divided by it, because PNG stores it unmultiplied. Without `keep_alpha` the result
/// is opaque: the picture over black.
Rgba8Image tone_map_image(const Image& linear, ToneMap kind, float exposure_stops = 0, bool keep_alpha = true);

inline constexpr ValueName<ToneMap> kToneMaps[] = {
    {ToneMap::Srgb, "srgb"}, {ToneMap::Agx, "agx"}, {ToneMap::Aces, "aces"}, {ToneMap::Neutral, "neutral"}};
constexpr const auto& names_of_all(ToneMap) { return kToneMaps; }

} // namespace pertev
