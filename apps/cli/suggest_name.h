#pragma once

// "Did you mean": the name that was perhaps meant by a misspelt one.

#include <span>
#include <string>
#include <string_view>

namespace pertev {

/// The one of `names` that is nearest to `name`; empty if none is near. Near means one letter in three wrong,
/// missing, added or swapped with its neighbour, the beginning of a name, or one of its words (`--depth`,
/// `--max-depth`). Case, leading dashes, and - versus _ are ignored. Among equally near names, one with the same
/// first letter is preferred, then the first.
std::string suggest_name(std::string_view name, std::span<const std::string> names);

} // namespace pertev
