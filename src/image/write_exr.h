#pragma once

// Writes OpenEXR: 32-bit float, or half for colours, lossless (ZIP of 16 rows; of one row if 16 exceed 256 MiB),
// scanlines; layers besides the picture; metadata. Equal pictures give equal bytes, because nothing depends on the time
// or the machine. Colours are Rec. 709, which is the default without the attribute `chromaticities`.

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

/// A layer besides the picture, of the picture's size; channel c is written as `name.channels[c]`.
struct ExrLayer {
    std::string name;                  // "albedo"
    std::vector<std::string> channels; // {"R", "G", "B"}, {"X", "Y", "Z"}, {"Z"}
    // Interleaved, [height * width * channels.size()]. Ids are integers, because float is exact only up to 2^24.
    std::variant<std::vector<float>, std::vector<uint32_t>> values;
    bool is_color = false; // may be stored as half
};

/// The place of a picture that is a part of another one: the data window is inside the display window. All zero: the
/// picture is whole.
struct ExrPlace {
    uint32_t x = 0, y = 0;                      // upper left pixel of the picture in the whole one
    uint32_t whole_width = 0, whole_height = 0; // size of the whole picture
    bool is_whole() const { return whole_width == 0; }
};

/// The numbers of colours in a file. Other layers have 32 bits, because half would change ids and round positions.
enum class ExrColors : uint8_t {
    Float,
    Half, // rounded to the nearest; beyond 65504 it is that number, so that no
          // finite light becomes infinite
};

/// Throws Error(OverLimit) if a row with this number of channels exceeds the limit of EXR, 1 GiB.
void check_exr_row(uint32_t width, std::size_t channels);

/// The file's bytes. Channels of `picture`: 1 Y, 2 Y A, 3 R G B, 4 R G B A (colour premultiplied by alpha, as in
/// EXR). Metadata with names of the format's own attributes ("channels", ...) is a programmer's mistake.
std::vector<std::byte> encode_exr(const Image& picture, std::span<const ExrLayer> layers = {},
                                  const ExrMetadata& metadata = {}, const ExrPlace& place = {},
                                  ExrColors colors = ExrColors::Float);

/// Replaces `path` atomically. Throws Error(FileWrite).
void write_exr(const std::filesystem::path& path, const Image& picture, std::span<const ExrLayer> layers = {},
               const ExrMetadata& metadata = {}, const ExrPlace& place = {}, ExrColors colors = ExrColors::Float);

} // namespace pertev
