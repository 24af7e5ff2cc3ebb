#pragma once

// How PNG and JPEG show a merged picture: as its parts say, or by another tone map or exposure.

#include <string>

#include "base/error.h"
#include "session/writing/picture_metadata.h"

namespace pertev {

/// A requested display, as the settings `tone_map` and `exposure`. Empty texts: that of the parts.
struct MergedDisplay {
    std::string tone_map, exposure;

    bool is_empty() const { return tone_map.empty() && exposure.empty(); }
};

/// Changes the display of a merged picture to what one render with these settings has, and what its files say of it.
/// `film` is one of its files. Throws Error(BadInput) for values that the settings cannot have, and if the light meter
/// would have to see the scene.
void show_merged(const MergedDisplay& requested, const std::string& film, PictureFacts& facts);

} // namespace pertev
