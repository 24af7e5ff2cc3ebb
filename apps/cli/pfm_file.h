#pragma once

// Portable float maps for other denoising programs: for measurements, not an image format of the product.
//
// Source: Debevec's PFM: "PF", width and height, a scale whose sign gives the byte order, rows of three floats from
// the bottom.

#include <filesystem>

#include "image/image.h"

namespace pertev {

/// `picture` has three channels. Throws Error(FileWrite).
void write_pfm(const std::filesystem::path& file, const Image& picture);

/// Reads three channels of this size in this machine's byte order. Throws Error(BadInput).
Image read_pfm(const std::filesystem::path& file, uint32_t width, uint32_t height);

} // namespace pertev
