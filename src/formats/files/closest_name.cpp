#include "formats/files/closest_name.h"

#include <algorithm>
#include <numeric>

#include <fmt/format.h>

namespace pertev {
namespace {

constexpr std::size_t kLongestWord = 64; // longer ones are not misspelt names

char lower_case(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

/// Levenshtein's distance, ignoring case.
std::size_t distance(std::string_view a, std::string_view b) {
    std::vector<std::size_t> row(b.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t(0));
    for (std::size_t i = 0; i < a.size(); ++i) {
        std::size_t diagonal = row[0];
        row[0] = i + 1;
        for (std::size_t k = 0; k < b.size(); ++k) {
            const std::size_t changed = diagonal + (lower_case(a[i]) != lower_case(b[k]) ? 1 : 0);
            diagonal = row[k + 1];
            row[k + 1] = std::min({changed, row[k] + 1, diagonal + 1});
        }
    }
    return row.back();
}

} // namespace

std::string_view closest_name(std::string_view word, std::span<const std::string_view> known) {
    if (word.size() > kLongestWord) return {};
    std::string_view best;
    std::size_t least = std::max<std::size_t>(word.size() / 3, 1) + 1;
    for (const std::string_view name : known.first(std::min(known.size(), kMostSuggestions))) {
        const std::size_t longer = std::max(word.size(), name.size()), shorter = std::min(word.size(), name.size());
        if (longer - shorter >= least) continue; // so many letters are missing at least
        const std::size_t changes = distance(word, name);
        if (changes >= least) continue;
        least = changes;
        best = name;
    }
    return best;
}

std::string did_you_mean(std::string_view word, std::span<const std::string_view> known) {
    const std::string_view name = closest_name(word, known);
    return name.empty() ? "" : fmt::format(" (did you mean \"{}\"?)", name);
}

} // namespace pertev
