#pragma once

// "Did you mean": the name that a misspelt one was perhaps meant to be.

#include <span>
#include <string>
#include <string_view>

namespace pertev {

/// The one of `names` that is nearest to `name`; empty where none is near. Near is a letter in three wrong, missing,
/// added or swapped with its neighbour, the beginning of a name, or one of its words (`--depth`, `--max-depth`). Case,
/// leading dashes, and whether words are joined by - or _ do not count. Of names that are equally near, one with the
/// same first letter, then the first.
std::string suggest_name(std::string_view name, std::span<const std::string> names);

} // namespace pertev
