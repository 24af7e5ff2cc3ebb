#pragma once

// The binary data of a document: its buffers, and the views into them, decompressed for EXT_ and
// KHR_meshopt_compression. Every view lies within its buffer.
//
// Source: glTF 2.0 section 3.6.1; EXT_meshopt_compression and KHR_meshopt_compression (release candidate).

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "formats/files/file_access.h"
#include "formats/gltf/document.h"

namespace pertev::gltf {

struct BufferView {
    std::span<const std::byte> bytes;
    uint64_t stride = 0; // bytes from one element to the next; 0: elements are contiguous
};

class Buffers {
public:
    /// Reads all buffers. A missing or badly encoded one is an error only once it is used, and so are the missing
    /// bytes of one that is too short.
    Buffers(const Document& document, const FileAccess& access, Sink& sink);

    /// The view with the index `reference`. Throws Error(BadInput) if it exceeds its buffer or cannot be
    /// decompressed.
    BufferView view(const JsonValue& reference);

    /// Counts `bytes` of memory that the reader fills because of the value `json`. A scene may use its data many
    /// times, but not without bound: throws Error(OverLimit) once the sum is out of proportion to the files.
    void charge(uint64_t bytes, const JsonValue& json);
    /// Gives contiguous `bytes` to the accessor with the index `reference`, which has no buffer view, in place of
    /// zeros.
    void put(const JsonValue& reference, std::vector<std::byte> bytes);
    /// Returns the bytes that an accessor was given; nothing if there are none.
    std::optional<std::span<const std::byte>> put_bytes(uint32_t accessor) const;
    /// Bytes of all files read: the JSON and the buffers.
    uint64_t file_bytes() const { return file_bytes_; }

private:
    std::span<const std::byte> read_uri(const JsonValue& uri, const FileAccess& access, Sink& sink);
    std::span<const std::byte> slice(const JsonValue& json) const;
    std::vector<std::byte> decompress(const JsonValue& compressed);

    const Document& document_;
    std::vector<std::vector<std::byte>> owned_;
    std::map<std::filesystem::path, std::span<const std::byte>> by_path_; // a file is read once
    std::vector<std::optional<std::span<const std::byte>>> buffers_;      // nothing for a placeholder, or why it is
                                                                          // missing is...
    std::vector<std::optional<Error>> faults_;                            // ...here
    std::vector<std::optional<std::vector<std::byte>>> decompressed_;     // [view]
    std::map<uint32_t, std::vector<std::byte>> put_;                      // by accessor
    uint64_t file_bytes_ = 0, charged_bytes_ = 0;
};

} // namespace pertev::gltf
