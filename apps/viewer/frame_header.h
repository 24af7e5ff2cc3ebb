#pragma once

// The header of a binary message to a page; the picture's bytes follow. Little endian, 32 bytes:
//   0 uint8 version (1)   1 uint8 kind   2 uint16 flags   4 uint32 frame   8 uint32 input   12 uint32 samples
//   16 uint16 width, 18 uint16 height: of the encoded picture   20 uint16, 22 uint16: of the full picture
//   24 uint32 offset, 28 uint32 total: of a piece, in bytes of the whole file

#include <array>
#include <cstddef>
#include <cstdint>

namespace pertev {

enum class PictureKind : uint8_t {
    Jpeg = 1,  // one whole picture
    Piece = 2, // a piece of a PNG: pieces come in order, and a newer frame ends them
};

inline constexpr uint16_t kFrameIsFinal = 1; // all samples are done

struct FrameHeader {
    PictureKind kind = PictureKind::Jpeg;
    uint16_t flags = 0;
    uint32_t frame = 0;   // ascending; acknowledgements refer to it
    uint32_t input = 0;   // the last input, of whoever steered, that this picture shows
    uint32_t samples = 0; // per pixel
    uint16_t width = 0, height = 0, full_width = 0, full_height = 0;
    uint32_t offset = 0, total = 0;
};

inline constexpr std::size_t kFrameHeaderBytes = 32;

inline std::array<uint8_t, kFrameHeaderBytes> bytes_of(const FrameHeader& header) {
    std::array<uint8_t, kFrameHeaderBytes> bytes{};
    const auto put = [&](std::size_t at, uint32_t value, int count) {
        for (int i = 0; i < count; ++i)
            bytes[at + static_cast<std::size_t>(i)] = static_cast<uint8_t>(value >> (8 * i));
    };
    put(0, 1, 1);
    put(1, static_cast<uint32_t>(header.kind), 1);
    put(2, header.flags, 2);
    put(4, header.frame, 4);
    put(8, header.input, 4);
    put(12, header.samples, 4);
    put(16, header.width, 2);
    put(18, header.height, 2);
    put(20, header.full_width, 2);
    put(22, header.full_height, 2);
    put(24, header.offset, 4);
    put(28, header.total, 4);
    return bytes;
}

} // namespace pertev
