#pragma once

// Finds the known name that a misspelt one probably means.

#include <span>
#include <string>
#include <string_view>

namespace pertev {

/// Returns the name of `known` that needs the fewest changed, missing or surplus letters to become `word`, ignoring the
/// case of A to Z; empty if even the best one needs more than a third of the word's letters.
std::string_view closest_name(std::string_view word, std::span<const std::string_view> known);

/// Returns ` (did you mean "NAME"?)` for the closest name; empty if there is none.
std::string did_you_mean(std::string_view word, std::span<const std::string_view> known);

} // namespace pertev
