#pragma once

// Identifies picture formats from the first bytes, because names and extensions may be wrong.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string_view>

namespace pertev {

enum class ImageFormat { Png, Jpeg, Hdr, Exr };
/// The format in a set of formats.
constexpr uint32_t bit_of(ImageFormat format) { return 1u << static_cast<uint32_t>(format); }

/// The format whose magic bytes `bytes` starts with; nothing for any other content.
std::optional<ImageFormat> recognise_image(std::span<const std::byte> bytes);

/// Extensions of pictures that are read and written.
inline constexpr std::string_view kPictureExtensions[] = {".exr", ".png", ".jpg", ".jpeg", ".hdr"};
/// Returns whether the name has one of kPictureExtensions, in either case.
bool is_picture_name(const std::filesystem::path& file);

} // namespace pertev
