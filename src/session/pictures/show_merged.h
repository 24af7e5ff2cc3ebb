#pragma once

// How PNG and JPEG show a merged picture: as its parts say, or by another tone map or exposure.

#include <string>

#include "session/writing/picture_metadata.h"
#include "settings/picture_options.h"

namespace pertev {

/// Changes a merged picture's display to the tone map, exposure and LUT that the caller gave, as one render with them
/// would have, and its files' metadata with it. `film` is one of its files. Throws Error(BadInput) if the light meter
/// would have to see the scene.
void show_merged(const PictureOptions& options, const std::string& film, PictureFacts& facts);

} // namespace pertev
