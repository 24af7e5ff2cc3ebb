#pragma once

// Names of files as clients may know them: without the folders of the machine that renders.

#include <string>

namespace pertev {

/// Returns the last part of a path. A name that is no path, such as that of a built-in scene or a colour, stays.
std::string file_name(const std::string& path);

/// Returns a message in which files have names in place of paths: those below the folder of the scene `scene` relative
/// to it, all others without any folder of this machine, in whatever spelling.
std::string without_folders(std::string message, const std::string& scene);

} // namespace pertev
