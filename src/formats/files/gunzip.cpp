#include "formats/files/gunzip.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <zlib.h>

#include "base/error.h"
#include "base/limits.h"
#include "base/read_file.h"

namespace pertev {
namespace {

/// A stream of zlib that ends with its scope.
struct Inflating {
    z_stream stream = {};
    Inflating(int window_bits, const std::string& file) {
        if (inflateInit2(&stream, window_bits) != Z_OK)
            throw Error(ErrorCode::OutOfMemory, FileLocation{file}, "zlib cannot begin to decompress");
    }
    Inflating(const Inflating&) = delete;
    Inflating& operator=(const Inflating&) = delete;
    ~Inflating() { inflateEnd(&stream); }
};

/// Inflates what begins in front of `bytes`; of gzip all members.
std::vector<std::byte> inflate_all(std::span<const std::byte> bytes, int window_bits, const std::string& file,
                                   uint64_t limit) {
    const bool has_members = window_bits > MAX_WBITS;
    constexpr std::size_t kPiece = std::size_t(1) << 20;
    Inflating inflating(window_bits, file);
    z_stream& stream = inflating.stream;
    std::vector<std::byte> content;
    std::size_t size = 0;
    const auto* in = reinterpret_cast<const Bytef*>(bytes.data());
    std::size_t left = bytes.size();
    int state = Z_OK;
    while (state != Z_STREAM_END || (has_members && left > 0 && is_gzip(bytes.last(left)))) {
        if (state == Z_STREAM_END) inflateReset(&stream); // a further member
        if (content.size() < size + kPiece)
            content.resize(std::min<uint64_t>(std::max(2 * content.size(), kPiece), limit + kPiece));
        stream.next_in = const_cast<Bytef*>(in + (bytes.size() - left)); // zlib does not write to it
        const auto given = static_cast<uInt>(std::min(left, kPiece));
        stream.avail_in = given;
        stream.next_out = reinterpret_cast<Bytef*>(content.data() + size);
        const auto room = static_cast<uInt>(std::min(content.size() - size, kPiece));
        stream.avail_out = room;
        state = inflate(&stream, Z_NO_FLUSH);
        left -= given - stream.avail_in;
        size += room - stream.avail_out;
        if (size > limit) {
            throw Error(ErrorCode::OverLimit, FileLocation{file},
                        fmt::format("the file decompresses to over {} MiB, more than its size justifies", limit >> 20));
        }
        const bool is_stuck = given == stream.avail_in && room == stream.avail_out;
        if ((state != Z_OK && state != Z_STREAM_END) || (state == Z_OK && is_stuck)) {
            throw Error(
                ErrorCode::BadInput, FileLocation{file},
                fmt::format("the compressed data are damaged or cut off after {} bytes of their content", size));
        }
    }
    content.resize(size);
    return content;
}

} // namespace

bool is_gzip(std::span<const std::byte> bytes) {
    return bytes.size() >= 18 && bytes[0] == std::byte{0x1f} && bytes[1] == std::byte{0x8b} && bytes[2] == std::byte{8};
}

std::vector<std::byte> gunzip(std::span<const std::byte> bytes, const std::string& file) {
    return gunzip(bytes, file, most_decompressed(bytes.size()));
}

std::vector<std::byte> gunzip(std::span<const std::byte> bytes, const std::string& file, uint64_t limit) {
    return inflate_all(bytes, 16 + MAX_WBITS, file, limit);
}

std::vector<std::byte> inflate_zlib(std::span<const std::byte> bytes, const std::string& file) {
    return inflate_all(bytes, MAX_WBITS, file, most_decompressed(bytes.size()));
}

UnzippedFile read_unzipped(const std::filesystem::path& path) {
    std::vector<std::byte> bytes = read_file(path);
    const uint64_t size = bytes.size();
    if (!is_gzip(bytes)) return {std::move(bytes), size};
    return {gunzip(bytes, path.string()), size};
}

} // namespace pertev
