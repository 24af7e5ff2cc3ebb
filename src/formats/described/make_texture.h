#pragma once

// Textures that are made of others.

#include "formats/described/texture_value.h"

namespace pertev::described {

/// Returns a * b. If both vary from place to place, only `a` does.
TextureValue product(const TextureValue& a, const TextureValue& b);

/// Returns an image of 2 x 2 pixels, of which the upper left one is `odd`.
TextureImage checks_of(Rgb even, Rgb odd);

} // namespace pertev::described
