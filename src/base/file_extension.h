#pragma once

// What a file is by its name: of formats that are told apart so.

#include <filesystem>
#include <string>

namespace pertev {

/// Of a file's name: ".png" of "Leaf.PNG". The letters A to Z alone become small, in every locale; empty where the name
/// has no extension.
std::string lower_case_extension(const std::filesystem::path& file);

} // namespace pertev
