#pragma once

// Writes OpenEXR: 32-bit float, lossless (ZIP of 16 rows; of one, where 16 are over 256 MiB), scanlines; further layers
// beside the picture; metadata. Equal pictures give equal bytes: nothing of the time or the machine goes in. Colours
// are Rec. 709. No attribute `chromaticities` says so, because that is what a file without one holds by the format's
// rule.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "image/exr_file.h"
#include "image/image.h"

namespace pertev {

/// One layer beside the picture, of the picture's size; channel c is written as `name.channels[c]`.
struct ExrLayer {
    std::string name;                  // "albedo"
    std::vector<std::string> channels; // {"R", "G", "B"}, {"X", "Y", "Z"}, {"Z"}
    // Interleaved, [height * width * channels.size()]. Ids are integers, since float is exact only up to 2^24.
    std::variant<std::vector<float>, std::vector<uint32_t>> values;
};

/// Throws Error(OverLimit) for a picture whose rows of so many channels an EXR cannot hold: over 1 GiB each.
void check_exr_row(uint32_t width, std::size_t channels);

/// The file's bytes. Channels of `picture`: 1 Y, 2 Y A, 3 R G B, 4 R G B A (colour premultiplied by alpha, as EXR
/// has it). Metadata names of the format's own attributes ("channels", ...) are a programmer's mistake.
std::vector<std::byte> encode_exr(const Image& picture, std::span<const ExrLayer> layers = {},
                                  const ExrMetadata& metadata = {});

/// Replaces `path` atomically. Throws Error(FileWrite).
void write_exr(const std::filesystem::path& path, const Image& picture, std::span<const ExrLayer> layers = {},
               const ExrMetadata& metadata = {});

} // namespace pertev
