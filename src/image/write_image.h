#pragma once

// Writes a rendered picture in the format of its file extension.

#include <cstdint>
#include <filesystem>
#include <span>

#include "image/display_image.h"
#include "image/image_format.h"
#include "image/write_exr.h"

namespace pertev {

/// The numbers that files have.
struct NumberFormats {
    ExrColors exr_colors = ExrColors::Float;
    bool png_has_16_bits = false;
};

struct WriteImageOptions {
    DisplayTransform display = {};         // for PNG and JPEG
    bool transparent = false;              // keeps alpha in PNG; EXR keeps what the picture has
    std::span<const ExrLayer> layers = {}; // EXR only
    ExrMetadata metadata = {};             // EXR only
    ExrPlace place = {};                   // EXR only
    NumberFormats numbers = {};
};

/// The format of a file to be written, by its case-insensitive extension: .exr .png .jpg .jpeg .hdr. Throws
/// Error(BadInput) that lists these for any other.
ImageFormat image_format_for(const std::filesystem::path& path);

/// Throws, with the name, what write_image would throw for this name and size, including Error(OverLimit) if the
/// format holds no picture that large. For use before a long render. Creates nothing that stays.
void check_image_output(const std::filesystem::path& path, uint32_t width, uint32_t height);

/// EXR and HDR contain `linear` (linear Rec. 709) unchanged; PNG and JPEG contain it tone-mapped. Replaces `path`
/// atomically. Throws Error(BadInput) for an unknown extension, Error(FileWrite) if the file cannot be written.
void write_image(const std::filesystem::path& path, const Image& linear, const WriteImageOptions& options = {});

} // namespace pertev
