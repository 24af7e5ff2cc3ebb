#pragma once

// The crop of a picture: the rectangle of its pixels that is rendered. Its film is a window (render/pixel_window.h), so
// it has the whole picture's bytes there; the light meter, random numbers and camera are those of the whole.

#include <optional>

#include "image/image.h"
#include "settings/picture_options.h"

namespace pertev {

/// Returns the requested crop; none if the whole picture is requested. Throws Error(BadInput) unless its numbers are
/// whole, with a width and a height of at least 1.
std::optional<PictureCrop> parse_crop(const PictureOptions& options);

/// Sets the crop of a picture whose size is set. Throws as parse_crop, and Error(BadInput) if the crop is not inside
/// the picture.
void set_crop(const PictureOptions& options, RenderSettings& settings);

/// Returns the pixels of a whole picture, or of a layer of it, that lie in the window.
Image pixels_in(const Image& whole, const PixelWindow& window);

} // namespace pertev
