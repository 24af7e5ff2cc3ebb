#pragma once

// Finds the known name that a misspelt one probably means.

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace pertev {

inline constexpr std::size_t kMostSuggestions = 1000;
inline constexpr std::size_t kMostWithSuggestion = 100; // faults of a file that get a suggestion, since each takes time

/// Returns the name of `known` that needs the fewest changed, missing or surplus letters to become `word`, ignoring the
/// case of A to Z; empty if even the best one needs more than a third of the word's letters. Only the first
/// kMostSuggestions names are compared, so that a file of many names and many faults is read quickly.
std::string_view closest_name(std::string_view word, std::span<const std::string_view> known);

/// Returns ` (did you mean "NAME"?)` for the closest name; empty if there is none.
std::string did_you_mean(std::string_view word, std::span<const std::string_view> known);

/// Returns the first names of a map for the functions above.
template <class Map>
std::vector<std::string_view> first_names(const Map& map) {
    std::vector<std::string_view> names;
    for (auto at = map.begin(); at != map.end() && names.size() < kMostSuggestions; ++at) names.push_back(at->first);
    return names;
}

} // namespace pertev
