#include "image/write_png.h"

#include <algorithm>
#include <limits>
#include <new>

#include <zlib.h>

#include "base/error.h"
#include "base/parallel_for.h"
#include "base/write_file_atomically.h"

namespace pertev {
namespace {

// Said outright, so that other defaults of the library cannot change the bytes. A rendered picture takes 2 % more bytes
// than by level 6 and the best filter of each row, and a quarter of the time.
constexpr int kLevel = 3, kWindowBits = 15, kMemory = 8;
constexpr unsigned char kStreamHeader[2] = {0x78, 0x5e}; // RFC 1950: a window of 32 KiB, a fast level
constexpr std::size_t kWindow = std::size_t(1) << kWindowBits;
constexpr std::size_t kPartBytes = std::size_t(1) << 17; // bytes of rows that one thread deflates at once

using Bytes = std::vector<std::byte>;

void append(Bytes& to, const void* from, std::size_t count) {
    const auto* const start = static_cast<const std::byte*>(from);
    to.insert(to.end(), start, start + count);
}

void append_number(Bytes& to, uint32_t number) { // the high byte first
    for (int shift = 24; shift >= 0; shift -= 8) to.push_back(static_cast<std::byte>(number >> shift & 0xff));
}

const Bytef* zlib_bytes(const std::byte* bytes) { return reinterpret_cast<const Bytef*>(bytes); }

/// Appends a chunk; `name` has four letters.
void append_chunk(Bytes& to, const char* name, const Bytes& data) {
    append_number(to, static_cast<uint32_t>(data.size()));
    const std::size_t start = to.size();
    append(to, name, 4);
    append(to, data.data(), data.size());
    append_number(to, static_cast<uint32_t>(crc32_z(0, zlib_bytes(to.data() + start), to.size() - start)));
}

/// Byte `i` of a pixel as a file has it, the high byte of a number first.
uint8_t byte_of(const uint8_t* rgba, std::size_t i) { return rgba[i]; }
uint8_t byte_of(const uint16_t* rgba, std::size_t i) {
    return static_cast<uint8_t>(i % 2 == 0 ? rgba[i / 2] >> 8 : rgba[i / 2] & 255);
}

/// Writes a row in the form of the file: filter 1 (Sub), then the difference of each byte from that of the pixel to the
/// left.
template <class Number>
void filter_row(const Number* rgba, uint32_t width, std::size_t channels, std::byte* to) {
    *to++ = std::byte{1};
    constexpr std::size_t kBytes = sizeof(Number);
    uint8_t left[4 * kBytes] = {};
    for (uint32_t x = 0; x < width; ++x, rgba += 4) {
        for (std::size_t i = 0; i < channels * kBytes; ++i) {
            const uint8_t byte = byte_of(rgba, i);
            *to++ = static_cast<std::byte>(byte - left[i]);
            left[i] = byte;
        }
    }
}

/// Returns bytes [begin, end) as a part of one deflate stream (RFC 1951). The part may refer to bytes before it and
/// ends at a whole byte. Throws std::bad_alloc.
Bytes deflate_part(const Bytes& bytes, std::size_t begin, std::size_t end) {
    z_stream stream{};
    if (deflateInit2(&stream, kLevel, Z_DEFLATED, -kWindowBits, kMemory, Z_FILTERED) != Z_OK) throw std::bad_alloc();
    struct Ends {
        z_stream& of;
        ~Ends() { deflateEnd(&of); }
    } const ends{stream};
    const std::size_t before = std::min(begin, kWindow);
    if (before > 0) {
        deflateSetDictionary(&stream, zlib_bytes(bytes.data() + begin - before), static_cast<uInt>(before));
    }
    Bytes part(deflateBound(&stream, static_cast<uLong>(end - begin)) + 16); // 16: the mark of the part's end
    stream.next_in = const_cast<Bytef*>(zlib_bytes(bytes.data() + begin));   // zlib only reads it
    stream.avail_in = static_cast<uInt>(end - begin);
    stream.next_out = reinterpret_cast<Bytef*>(part.data());
    stream.avail_out = static_cast<uInt>(part.size());
    const bool is_last = end == bytes.size();
    const int made = deflate(&stream, is_last ? Z_FINISH : Z_SYNC_FLUSH);
    PERTEV_CHECK(made == (is_last ? Z_STREAM_END : Z_OK) && stream.avail_in == 0 && stream.avail_out > 0);
    part.resize(stream.total_out);
    part.shrink_to_fit(); // all parts are kept
    return part;
}

/// Returns one zlib stream (RFC 1950) in parts of `part_bytes` input bytes, so that the stream does not depend on the
/// number of threads.
std::vector<Bytes> deflate_in_parts(const Bytes& bytes, std::size_t part_bytes) {
    PERTEV_CHECK(part_bytes < std::numeric_limits<uInt>::max() / 2);
    struct Part {
        Bytes deflated;
        uLong sum;
    };
    std::vector<Part> parts((bytes.size() - 1) / part_bytes + 1);
    const auto end_of = [&](std::size_t i) { return std::min((i + 1) * part_bytes, bytes.size()); };
    parallel_for(parts.size(), 1, [&](uint64_t i) {
        const std::size_t begin = i * part_bytes, end = end_of(i);
        parts[i] = {deflate_part(bytes, begin, end), adler32_z(1, zlib_bytes(bytes.data() + begin), end - begin)};
    });
    std::vector<Bytes> stream;
    uLong sum = 1; // checksum of no bytes
    for (std::size_t i = 0; i < parts.size(); ++i) {
        sum = adler32_combine(sum, parts[i].sum, static_cast<z_off_t>(end_of(i) - i * part_bytes));
        stream.push_back(std::move(parts[i].deflated));
    }
    const auto* const header = reinterpret_cast<const std::byte*>(kStreamHeader);
    stream.front().insert(stream.front().begin(), header, header + sizeof kStreamHeader);
    append_number(stream.back(), static_cast<uint32_t>(sum));
    return stream;
}

template <class Number>
Bytes encode(uint32_t width, uint32_t height, const std::vector<Number>& pixels, bool with_alpha) {
    const std::size_t row_numbers = std::size_t(width) * 4, channels = with_alpha ? 4 : 3;
    PERTEV_CHECK(row_numbers > 0 && height > 0 && pixels.size() == row_numbers * height);
    const std::size_t row_bytes = 1 + width * channels * sizeof(Number);
    const std::size_t rows = std::max(kPartBytes / row_bytes, std::size_t(1)); // rows of a part
    Bytes filtered(row_bytes * height);
    parallel_for(height, rows, [&](uint64_t y) {
        filter_row(pixels.data() + y * row_numbers, width, channels, filtered.data() + y * row_bytes);
    });
    const unsigned char kind[5] = {8 * sizeof(Number), static_cast<unsigned char>(with_alpha ? 6 : 2), 0, 0,
                                   0}; // bits, RGBA or RGB
    Bytes header;
    append_number(header, width);
    append_number(header, height);
    append(header, kind, sizeof kind);
    Bytes file;
    append(file, "\x89PNG\r\n\x1a\n", 8);
    append_chunk(file, "IHDR", header);
    append_chunk(file, "sRGB", {std::byte{0}}); // perceptual
    for (const Bytes& part : deflate_in_parts(filtered, rows * row_bytes)) append_chunk(file, "IDAT", part);
    append_chunk(file, "IEND", {});
    return file;
}

} // namespace

Bytes encode_png(const Rgba8Image& picture, bool with_alpha) {
    return encode(picture.width, picture.height, picture.pixels, with_alpha);
}
Bytes encode_png(const Rgba16Image& picture, bool with_alpha) {
    return encode(picture.width, picture.height, picture.pixels, with_alpha);
}

void write_png(const std::filesystem::path& path, const Rgba8Image& picture, bool with_alpha) {
    write_file_atomically(path, encode_png(picture, with_alpha));
}
void write_png(const std::filesystem::path& path, const Rgba16Image& picture, bool with_alpha) {
    write_file_atomically(path, encode_png(picture, with_alpha));
}

} // namespace pertev
