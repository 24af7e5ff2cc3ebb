#pragma once

// A small JSON file of ours, whose values know their location (formats/json/json_value.h).

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "formats/json/json_value.h"

namespace pertev {

class JsonFile {
public:
    /// Reads and parses a file. Throws Error(BadInput) if it cannot be read or is not JSON, with the location of the
    /// first fault.
    explicit JsonFile(const std::filesystem::path& path);
    /// Parses the text of a file, or of a part of it.
    JsonFile(std::string name, std::string_view text);
    JsonFile(const JsonFile&) = delete; // values point into the file
    JsonFile& operator=(const JsonFile&) = delete;

    const gltf::JsonValue& root() const { return *root_; }

private:
    std::string name_; // the path, for messages
    simdjson::dom::parser parser_;
    std::optional<gltf::JsonValue> root_;
};

} // namespace pertev
