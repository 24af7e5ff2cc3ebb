#pragma once

// File extensions, for formats that are identified by them.

#include <filesystem>
#include <string>

namespace pertev {

/// Lower-case extension of a file's name: ".png" for "Leaf.PNG". Only the letters A to Z are converted, in every
/// locale; empty if the name has no extension.
inline std::string lower_case_extension(const std::filesystem::path& file) {
    std::string extension = file.extension().string();
    for (char& c : extension) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    return extension;
}

} // namespace pertev
