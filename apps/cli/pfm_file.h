#pragma once

// Portable float maps, as other denoisers' programs read and write them: for measurements, not a format of pictures.
//
// Source: Debevec's PFM: "PF", width and height, a scale whose sign tells the byte order, rows of three floats from the
// bottom.

#include <filesystem>

#include "image/image.h"

namespace pertev {

/// `picture` has three channels. Throws Error(FileWrite).
void write_pfm(const std::filesystem::path& file, const Image& picture);

/// Three channels, of this size and in this machine's order of bytes. Throws Error(BadInput).
Image read_pfm(const std::filesystem::path& file, uint32_t width, uint32_t height);

} // namespace pertev
