#pragma once

// Names of files as clients may know them: without the folders of the machine that renders.

#include <string>

namespace pertev {

/// Returns the last part of a path. A name that is no path, such as that of a built-in scene or a colour, stays.
std::string file_name(const std::string& path);

/// Returns a message with names of files in place of paths into the folder of `path`.
std::string without_folder(std::string message, const std::string& path);

} // namespace pertev
