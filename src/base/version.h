#pragma once

// Which Pertev this is. The definitions are written by cmake/write_version.cmake at every build.

namespace pertev {

/// Release, such as "0.1.0".
const char* version();

/// Commit the program was built from: 12 hexadecimal digits, a `+` behind them where files were changed since. Empty
/// where the sources are not in a git repository.
const char* git_commit();

} // namespace pertev
