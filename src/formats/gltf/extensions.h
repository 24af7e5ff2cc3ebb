#pragma once

// Which extensions this reader knows, and how a file is converted that needs one of the others.

#include <filesystem>
#include <string>
#include <string_view>

namespace pertev::gltf {

/// Whether nothing is to be said of an extension: it is read, or it changes no picture, or what needs it says so where
/// it is used.
bool is_known_extension(std::string_view name);

/// The command that writes `file` without this extension, as a sentence that begins with a semicolon; empty where none
/// is known.
std::string conversion_advice(std::string_view extension, const std::filesystem::path& file);

} // namespace pertev::gltf
