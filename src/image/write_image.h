#pragma once

// Writes a rendered picture in the format that its file name asks for.

#include <cstdint>
#include <filesystem>
#include <span>

#include "image/image_format.h"
#include "image/tone_map.h"
#include "image/write_exr.h"

namespace pertev {

struct WriteImageOptions {
    ToneMap tone_map = ToneMap::Srgb;      // of PNG and JPEG
    float exposure_stops = 0;              // of PNG and JPEG
    bool transparent = false;              // keep alpha in PNG; EXR keeps what the picture has
    std::span<const ExrLayer> layers = {}; // EXR alone
    ExrMetadata metadata = {};             // EXR alone
};

/// The format of a file to be written, by its extension in any case: .exr .png .jpg .jpeg .hdr. Throws
/// Error(BadInput) that lists these for any other.
ImageFormat image_format_for(const std::filesystem::path& path);

/// Throws, with the name, what write_image would for this name and size, Error(OverLimit) included where the format
/// holds no picture that large: to be asked before a long render. Creates nothing that stays.
void check_image_output(const std::filesystem::path& path, uint32_t width, uint32_t height);

/// EXR and HDR hold `linear` (linear Rec. 709) as it is; PNG and JPEG hold it tone-mapped. Replaces `path` atomically.
/// Throws Error(BadInput) for an unknown extension, Error(FileWrite) when the file cannot be written.
void write_image(const std::filesystem::path& path, const Image& linear, const WriteImageOptions& options = {});

} // namespace pertev
