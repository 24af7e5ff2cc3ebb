#pragma once

// Names of files for clients: without the folders of the machine that renders.

#include <string>

namespace pertev {

/// Returns the last part of a path. A name that is no path, such as that of a built-in scene or a colour, does not
/// change.
std::string file_name(const std::string& path);

/// Returns a message with names of files in place of paths: files below the folder of the scene `scene` relative to
/// it, all others without any folder of this machine, however they are spelled.
std::string without_folders(std::string message, const std::string& scene);

} // namespace pertev
