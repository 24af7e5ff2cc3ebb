#pragma once

// Writes Radiance HDR: RGBE, new run-length coding, rows from the top.

#include <cstddef>
#include <filesystem>
#include <vector>

#include "image/image.h"

namespace pertev {

/// Rounds to the nearest RGBE value: 8 bits below the largest channel's leading bit. Negative values and NaN become
/// 0, infinity the largest value. Alpha is dropped; grey is repeated.
std::vector<std::byte> encode_hdr(const Image& linear);

/// Replaces `path` atomically. Throws Error(FileWrite).
void write_hdr(const std::filesystem::path& path, const Image& linear);

} // namespace pertev
