#pragma once

// Reads any picture file as one linear float picture, for comparisons and environment maps.

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>

#include "base/sink.h"
#include "image/image.h"

namespace pertev {

/// Reads the picture at `path` as linear Rec. 709. PNG and JPEG are decoded as sRGB; their alpha is kept (4 channels)
/// if some pixel is not opaque. Colours of EXR and HDR are converted from the primaries that the file states. Grey
/// becomes RGB, so the result has 3 or 4 channels. Throws as read_file and decode_image do.
Image read_image(const std::filesystem::path& path, Sink& sink = nobody());
/// Reads a picture from memory; `name` starts every message.
Image read_image(std::span<const std::byte> bytes, const std::string& name, Sink& sink = nobody());

} // namespace pertev
