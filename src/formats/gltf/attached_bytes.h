#pragma once

// The bytes of a file that an object of the document has by a bufferView or a URI.

#include <cstddef>
#include <span>
#include <vector>

#include "formats/files/file_access.h"
#include "formats/gltf/buffers.h"

namespace pertev::gltf {

/// Returns the bytes, which `owned` holds if they are in no buffer. Throws Error(BadInput) if they cannot be read.
std::span<const std::byte> attached_bytes(const Document& document, Buffers& buffers, const FileAccess& access,
                                          const JsonValue& holder, std::vector<std::byte>& owned, Sink& sink);

} // namespace pertev::gltf
