#pragma once

// Which picture format a file holds, told from its first bytes: names and extensions lie.

#include <cstddef>
#include <optional>
#include <span>

namespace pertev {

enum class ImageFormat { Png, Jpeg, Hdr, Exr };

/// The format whose magic bytes `bytes` starts with; nothing for any other content.
std::optional<ImageFormat> recognise_image(std::span<const std::byte> bytes);

} // namespace pertev
