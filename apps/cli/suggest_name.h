#pragma once

// Finds the flag, verb or setting that an unknown name probably means.

#include <span>
#include <string>
#include <string_view>

namespace pertev {

/// Returns the one of `names` that other renderers call `name`, or that is nearest to it; empty if none is. Near means
/// one letter in three wrong, missing, added or swapped with its neighbour, the beginning of a name, one of its words
/// (`--depth`, `--max-depth`), or a name with further words (`--fov-deg`, `--fov`). Case, leading dashes, and - versus
/// _ are ignored. Among equally near names, one with the same first letter is preferred, then the first.
std::string suggest_name(std::string_view name, std::span<const std::string> names);

} // namespace pertev
