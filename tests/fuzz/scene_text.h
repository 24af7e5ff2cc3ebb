#pragma once

// Inputs of fuzz targets, as text or as files.

#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "scene/validate/validate.h"

namespace pertev {

inline std::vector<std::byte> bytes_of_text(std::string_view text) {
    std::vector<std::byte> bytes(text.size());
    std::memcpy(bytes.data(), text.data(), text.size());
    return bytes;
}

/// Returns the path of an input in a folder of this process that has no other file.
inline std::filesystem::path input_path(std::string_view format, std::string_view name) {
    std::filesystem::path folder = std::filesystem::temp_directory_path() /
                                   ("pertev-fuzz-" + std::string(format) + "-" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder);
    return folder / name;
}

inline void write_bytes(const std::filesystem::path& path, std::span<const std::byte> bytes) {
    std::FILE* const file = std::fopen(path.c_str(), "wb");
    if (file == nullptr || std::fwrite(bytes.data(), 1, bytes.size(), file) != bytes.size()) std::abort();
    std::fclose(file);
}

/// Calls read() and returns what it does; false if it refuses the input by an Error of damaged or too large input.
template <class Read>
bool reads(const Read& read) {
    try {
        return read();
    } catch (const Error& error) {
        if (error.code() != ErrorCode::BadInput && error.code() != ErrorCode::OverLimit) throw;
    }
    return false;
}

/// Aborts if a scene is refused though something of it can be drawn. Returns whether something can.
inline bool check_scene(Scene& scene, const std::string& file, Messages& messages) {
    try {
        validate(scene, file, messages);
    } catch (const Error& error) {
        if (!scene.instances.empty()) std::fprintf(stderr, "%s\n", error.what()), std::abort();
    }
    return !scene.instances.empty();
}

} // namespace pertev
