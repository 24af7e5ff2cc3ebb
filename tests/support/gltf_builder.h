#pragma once

// Small glTF files made by tests, from numbers for binary data and JSON text for the rest.

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "base/sink.h"
#include "scene/scene.h"

namespace pertev::test {

/// Encodes base64 (RFC 4648, section 4) with padding.
std::string base64(std::span<const std::byte> bytes);

class GltfBuilder {
public:
    /// Appends numbers to the buffer (at a multiple of 4 bytes) and returns the index of a view of them. `members` are
    /// additional JSON members of the view, starting with a comma.
    template <class T>
    int add_view(const std::vector<T>& numbers, const std::string& members = "") {
        return add_view_of_bytes(std::as_bytes(std::span(numbers)), members);
    }
    int add_view_of_bytes(std::span<const std::byte> bytes, const std::string& members = "");
    /// Adds a view of `count` elements of `stride` bytes, compressed by EXT_meshopt_compression into `bytes`.
    /// `members` are the extension's mode and filter, `prefix` begins its name.
    int add_compressed_view(const std::vector<unsigned char>& bytes, std::size_t stride, std::size_t count,
                            const std::string& members, const std::string& prefix = "EXT");

    /// Appends numbers and returns the index of an accessor over all of them.
    template <class T>
    int add(const char* type, const std::vector<T>& numbers, const std::string& members = "") {
        const std::size_t count = numbers.size() / components_of(type);
        return add_accessor("\"bufferView\":" + std::to_string(add_view(numbers)) +
                            ",\"componentType\":" + std::to_string(component_type<T>()) + ",\"type\":\"" + type +
                            "\",\"count\":" + std::to_string(count) + members);
    }
    /// Adds an accessor with these members of its JSON object.
    int add_accessor(const std::string& members);

    /// Returns the document. `members` are its other top-level members, without the outer braces.
    std::string json(const std::string& members) const;
    /// Returns the document as a GLB file.
    std::vector<std::byte> glb(const std::string& members) const;

private:
    std::string tables(const std::string& uri) const;
    static std::size_t components_of(const std::string& type);
    template <class T>
    static int component_type() {
        if (std::is_same_v<T, float>) return 5126;
        if (std::is_same_v<T, uint32_t>) return 5125;
        if (std::is_same_v<T, uint16_t>) return 5123;
        if (std::is_same_v<T, int16_t>) return 5122;
        if (std::is_same_v<T, uint8_t>) return 5121;
        return 5120;
    }

    std::vector<std::byte> data_;
    std::string views_, accessors_;
    int view_count_ = 0, accessor_count_ = 0;
};

/// Writes "model.gltf" into a new folder and reads it.
Scene read_gltf_text(const std::string& json, Messages& messages, bool geometry_only = false);
Scene read_gltf_text(const std::string& json);
/// Returns the fault of a document, from "model.gltf" on: the message of the Error that reading throws, or the first
/// warning of something left out, without the part that names it; "" if there is neither. Other exceptions are passed
/// on.
std::string gltf_fault(const std::string& json);
/// Returns whether a warning contains all of `parts`.
bool has_warning(const Messages& messages, const std::vector<std::string>& parts);

} // namespace pertev::test
