#pragma once

// Every layer and the metadata of an OpenEXR file.

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>

#include "image/exr_file.h"

namespace pertev {

/// Reads all channels of all parts. Throws Error(BadInput), which names the file, if it is damaged or not EXR.
ExrFile read_exr(const std::filesystem::path& path);
/// Reads a file from memory; `name` starts every message.
ExrFile read_exr(std::span<const std::byte> bytes, const std::string& name);

} // namespace pertev
