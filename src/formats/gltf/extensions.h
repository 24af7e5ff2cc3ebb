#pragma once

// The extensions that this reader supports, and how to convert a file that needs another one.

#include <filesystem>
#include <string>
#include <string_view>

namespace pertev::gltf {

/// Returns whether an extension needs no message: it is read, or it changes no picture, or its users report it.
bool is_known_extension(std::string_view name);

/// A command that writes `file` without this extension, as a clause that begins with a semicolon; empty if none is
/// known.
std::string conversion_advice(std::string_view extension, const std::filesystem::path& file);

} // namespace pertev::gltf
