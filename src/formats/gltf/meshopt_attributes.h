#pragma once

// Vertex data of KHR_meshopt_compression that EXT_meshopt_compression does not have, and that the libmeshoptimizer of
// Debian 12 and Ubuntu 24.04 cannot decode: version 1 of the codec for attributes, and the filter for colours.
//
// Source: KHR_meshopt_compression, appendices A (mode 0) and B (filter 4).

#include <cstddef>
#include <span>

namespace pertev::gltf {

/// Returns whether a stream of attributes has version 1.
bool has_meshopt_version_1(std::span<const std::byte> stream);

/// Decodes a stream of version 1 into elements of `stride` bytes, a multiple of 4 up to 256, that fill `elements`.
/// Returns false if the stream is damaged.
bool decode_meshopt_attributes(std::span<const std::byte> stream, std::size_t stride, std::span<std::byte> elements);

/// Replaces colours of four components of 8 or 16 bits (`stride` is 4 or 8) by red, green, blue and alpha.
void decode_meshopt_colors(std::span<std::byte> colors, std::size_t stride);

} // namespace pertev::gltf
