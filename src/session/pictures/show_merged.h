#pragma once

// How PNG and JPEG show a merged picture: as its parts say, or by another tone map or exposure.

#include <string>

#include "session/writing/picture_metadata.h"
#include "settings/picture_options.h"

namespace pertev {

/// Changes the display of a merged picture to what one render with the given of `tone_map` and `exposure` has, and what
/// its files say of it. `film` is one of its files. Throws Error(BadInput) if the light meter would have to see the
/// scene.
void show_merged(const PictureOptions& options, const std::string& film, PictureFacts& facts);

} // namespace pertev
