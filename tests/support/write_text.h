#pragma once

// Small input files that tests write.

#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

namespace pertev::test {

/// Writes a file and returns `path`. It is not flushed to the disk, because tests write thousands of files.
inline std::filesystem::path write_text(const std::filesystem::path& path, const std::string& text) {
    std::ofstream file(path, std::ios::binary);
    if (!(file << text).flush()) throw std::runtime_error("a test's input could not be written: " + path.string());
    return path;
}

} // namespace pertev::test
