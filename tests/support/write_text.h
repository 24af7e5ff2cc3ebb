#pragma once

// Small input files written by the test itself.

#include <filesystem>
#include <span>
#include <string>

#include "base/write_file_atomically.h"

namespace pertev::test {

/// Returns `path`.
inline std::filesystem::path write_text(const std::filesystem::path& path, const std::string& text) {
    write_file_atomically(path, std::as_bytes(std::span(text)));
    return path;
}

} // namespace pertev::test
