#pragma once

// Textures that are made of others.

#include "formats/described/texture_value.h"

namespace pertev::described {

/// Returns a * b. If both vary from place to place, only `a` does.
TextureValue product(const TextureValue& a, const TextureValue& b);

/// Returns a texture as a number, where no colour is expected. Of colours without an image the mean counts, and of
/// texels what `grey_of` says, unless `value` says it already.
TextureValue as_number(TextureValue value, GreyOf grey_of = GreyOf::Mean);

/// Returns whether the channels of some texel differ.
bool has_colors(const TextureImage& image);

/// Returns an image of 2 x 2 pixels, of which the upper left one is `odd`.
TextureImage checks_of(Rgb even, Rgb odd);

} // namespace pertev::described
