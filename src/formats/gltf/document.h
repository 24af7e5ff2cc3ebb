#pragma once

// A glTF 2.0 document, from .gltf (JSON) or .glb (JSON and a binary chunk in a container), distinguished by content.
//
// Source: Khronos glTF 2.0 specification, sections 3.2, 3.12 and 4.4.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <simdjson.h>

#include "base/sink.h"
#include "formats/json/json_value.h"

namespace pertev::gltf {

class Document {
public:
    /// Parses the file. Throws Error(BadInput) if it is not JSON or not glTF 2. Warns of each required or used
    /// extension that is left out.
    Document(const std::filesystem::path& path, std::vector<std::byte> bytes, Sink& sink);
    Document(const Document&) = delete; // values point into the document
    Document& operator=(const Document&) = delete;

    const std::filesystem::path& path() const { return path_; }
    const std::string& file() const { return file_; } // the path, for messages
    const JsonValue& root() const { return *root_; }
    /// The binary chunk of a .glb; nothing if there is none.
    std::optional<std::span<const std::byte>> binary_chunk() const { return binary_chunk_; }
    uint64_t file_bytes() const { return bytes_.size(); }

    /// A top-level array, for instance "accessors"; empty if the file has none. Lights are under "lights".
    const std::vector<JsonValue>& table(std::string_view name) const;
    /// The number in `reference` as an index into table(name). Throws Error(BadInput) if there is no such element.
    uint32_t index_into(std::string_view name, const JsonValue& reference) const;
    const JsonValue& item(std::string_view name, const JsonValue& reference) const {
        return table(name)[index_into(name, reference)];
    }

private:
    void split_glb(Sink& sink);
    void read_table(std::string_view name, const JsonValue& holder, Sink& sink);
    std::size_t glb_end(Sink& sink) const;
    struct ChunkEnd {
        std::size_t end, next = 0; // offsets in the file: end of its data, and start of the next chunk
    };
    ChunkEnd json_chunk_end(std::size_t begin, std::size_t size, Sink& sink) const;
    std::size_t binary_chunk_end(std::size_t begin, std::size_t size, Sink& sink) const;
    void parse(std::span<const std::byte> json, Sink& sink);
    Error bad_json(std::string_view text, simdjson::error_code failure) const;
    void check_version(Sink& sink) const;
    void check_extensions(Sink& sink) const;

    std::filesystem::path path_;
    std::string file_;
    std::vector<std::byte> bytes_;
    std::span<const std::byte> json_chunk_;
    std::optional<std::span<const std::byte>> binary_chunk_;
    simdjson::dom::parser parser_;
    std::optional<JsonValue> root_;
    std::map<std::string, std::vector<JsonValue>, std::less<>> tables_;
};

} // namespace pertev::gltf
