#include "session/film_file/packed_plane.h"

#include <algorithm>
#include <new>
#include <optional>

#include <zlib.h>

namespace pertev {
namespace {

enum class PlaneKind : uint8_t { Constant, Plain, Deflated };

constexpr int kLevel = 6, kRawStream = -MAX_WBITS, kMemoryLevel = 9;

Bytef* zlib_bytes(const std::byte* bytes) { return const_cast<Bytef*>(reinterpret_cast<const Bytef*>(bytes)); }

/// Returns the plane deflated by one of zlib's strategies; nothing if that takes more than `most` bytes.
std::optional<std::vector<std::byte>> deflate_by(int strategy, std::span<const std::byte> plane, std::size_t most) {
    z_stream stream = {};
    if (deflateInit2(&stream, kLevel, Z_DEFLATED, kRawStream, kMemoryLevel, strategy) != Z_OK) throw std::bad_alloc();
    std::vector<std::byte> shorter(most);
    stream.next_in = zlib_bytes(plane.data()), stream.avail_in = static_cast<uInt>(plane.size());
    stream.next_out = zlib_bytes(shorter.data()), stream.avail_out = static_cast<uInt>(shorter.size());
    const bool is_shorter = deflate(&stream, Z_FINISH) == Z_STREAM_END;
    shorter.resize(stream.total_out);
    deflateEnd(&stream);
    return is_shorter ? std::optional(std::move(shorter)) : std::nullopt;
}

/// Returns the deflated plane; nothing if that is not shorter by more than its size takes. Noise, which most planes
/// are, is shorter without references to what came before.
std::optional<std::vector<std::byte>> deflate_plane(std::span<const std::byte> plane) {
    if (plane.size() <= sizeof(uint32_t) + 1) return std::nullopt;
    std::optional<std::vector<std::byte>> shortest;
    for (const int strategy : {Z_DEFAULT_STRATEGY, Z_HUFFMAN_ONLY}) {
        const std::size_t known = shortest ? shortest->size() : plane.size() - sizeof(uint32_t);
        if (known > 1) {
            if (auto shorter = deflate_by(strategy, plane, known - 1)) shortest = std::move(shorter);
        }
    }
    return shortest;
}

bool inflate_plane(std::span<const std::byte> packed, std::span<std::byte> plane) {
    z_stream stream = {};
    if (inflateInit2(&stream, kRawStream) != Z_OK) throw std::bad_alloc();
    stream.next_in = zlib_bytes(packed.data()), stream.avail_in = static_cast<uInt>(packed.size());
    stream.next_out = zlib_bytes(plane.data()), stream.avail_out = static_cast<uInt>(plane.size());
    const bool is_whole = inflate(&stream, Z_FINISH) == Z_STREAM_END && stream.avail_in == 0 && stream.avail_out == 0;
    inflateEnd(&stream);
    return is_whole;
}

} // namespace

void pack_plane(std::span<const std::byte> plane, std::vector<std::byte>& packed) {
    if (std::ranges::all_of(plane, [&](std::byte b) { return b == plane.front(); })) {
        packed.push_back(std::byte(PlaneKind::Constant));
        packed.push_back(plane.front());
    } else if (const auto deflated = deflate_plane(plane)) {
        const auto size = static_cast<uint32_t>(deflated->size());
        packed.push_back(std::byte(PlaneKind::Deflated));
        append(std::as_bytes(std::span(&size, 1)), packed);
        append(*deflated, packed);
    } else {
        packed.push_back(std::byte(PlaneKind::Plain));
        append(plane, packed);
    }
}

bool take_plane(std::span<const std::byte>& packed, std::span<std::byte> plane) {
    if (packed.empty()) return false;
    const auto kind = static_cast<PlaneKind>(packed.front());
    packed = packed.subspan(1);
    uint32_t size = kind == PlaneKind::Constant ? 1 : static_cast<uint32_t>(plane.size());
    if (kind == PlaneKind::Deflated && !take_size(packed, size)) return false;
    if (size > packed.size()) return false;
    const std::span<const std::byte> bytes = packed.first(size);
    packed = packed.subspan(size);
    if (kind == PlaneKind::Deflated) return inflate_plane(bytes, plane);
    if (kind == PlaneKind::Constant) std::ranges::fill(plane, bytes.front());
    if (kind == PlaneKind::Plain) std::ranges::copy(bytes, plane.begin());
    return kind == PlaneKind::Constant || kind == PlaneKind::Plain;
}

} // namespace pertev
