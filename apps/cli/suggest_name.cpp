#include "apps/cli/suggest_name.h"

#include <algorithm>
#include <vector>

namespace pertev {
namespace {

std::string plain(std::string_view name) {
    std::string text(name.substr(std::min(name.find_first_not_of('-'), name.size())));
    for (char& c : text) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c == '_' ? '-' : c;
    return text;
}

/// Letters to change, add, take away or swap with their neighbour (optimal string alignment).
std::size_t distance(std::string_view a, std::string_view b) {
    std::vector<std::size_t> before(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
    for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
    for (std::size_t i = 1; i <= a.size(); ++i) {
        before.swap(last);
        last.swap(row);
        row[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1)});
            const bool is_swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
            if (is_swapped) row[j] = std::min(row[j], before[j - 2] + 1);
        }
    }
    return row[b.size()];
}

bool has_word(std::string_view name, std::string_view word) {
    return ('-' + std::string(name) + '-').find('-' + std::string(word) + '-') != std::string::npos;
}

} // namespace

std::string suggest_name(std::string_view name, std::span<const std::string> names) {
    const std::string wanted = plain(name);
    std::string best;
    if (wanted.empty()) return "";
    const std::size_t most = std::max<std::size_t>(wanted.size() / 3, wanted.size() > 1 ? 1 : 0);
    std::size_t least = 2 * most + 2;
    for (const std::string& known : names) {
        const std::string candidate = plain(known);
        if (candidate.empty()) continue;
        const bool is_part = wanted.size() > 2 && (candidate.starts_with(wanted) || has_word(candidate, wanted));
        std::size_t far = distance(wanted, candidate);
        if (candidate.size() == 1 && far > 0) continue; // one letter is near to everything short
        if (is_part) far = std::min<std::size_t>(far, 1);
        if (far > most) continue;
        const std::size_t score =
            2 * far + (candidate.front() == wanted.front() ? 0 : 1); // first letters are seldom wrong
        if (score < least) {
            least = score;
            best = known;
        }
    }
    return best;
}

} // namespace pertev
