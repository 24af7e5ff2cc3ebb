#pragma once

// The binary data of a document: its buffers, and the views into them, decompressed where EXT_meshopt_compression
// says so. Every view handed out lies within its buffer.
//
// Source: glTF 2.0 section 3.6.1; EXT_meshopt_compression.

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
    uint64_t stride = 0; // bytes from one element to the next; 0: elements touch
};

class Buffers {
public:
    /// Reads all buffers. One that is missing or badly encoded is an error only once something uses it, and so is what
    /// one that is too short lacks.
    Buffers(const Document& document, const FileAccess& access, Messages& messages);

    /// The view that `reference` numbers. Throws Error(BadInput) when it leaves its buffer or cannot be decompressed.
    BufferView view(const JsonValue& reference);

    /// Counts `bytes` of memory that the value at `place` makes the reader fill. A scene may use its data many times
    /// over, but not without bound: throws Error(OverLimit) once the sum is out of all proportion to the files.
    void charge(uint64_t bytes, const JsonValue& place);
    /// Bytes of all files read: the JSON, the buffers.
    uint64_t file_bytes() const { return file_bytes_; }

private:
    std::span<const std::byte> read_uri(const JsonValue& uri, const FileAccess& access, Messages& messages);
    std::span<const std::byte> slice(const JsonValue& place) const;
    std::vector<std::byte> decompress(const JsonValue& compressed);

    const Document& document_;
    std::vector<std::vector<std::byte>> owned_;
    std::map<std::filesystem::path, std::span<const std::byte>> by_path_; // a file is read once
    std::vector<std::optional<std::span<const std::byte>>> buffers_;      // nothing: a placeholder, or why not is...
    std::vector<std::optional<Error>> faults_;                            // ...here
    std::vector<std::optional<std::vector<std::byte>>> decompressed_;     // by view
    uint64_t file_bytes_ = 0, charged_bytes_ = 0;
};

} // namespace pertev::gltf
