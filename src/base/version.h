#pragma once

// The version of Pertev. cmake/write_version.cmake writes the definitions at every build.

namespace pertev {

/// Release, such as "0.2.0".
const char* version();

/// Commit from which the program was built: 12 hexadecimal digits, followed by `+` if files were changed since.
/// `unknown` if the sources are not a git repository of their own.
const char* git_commit();

} // namespace pertev
