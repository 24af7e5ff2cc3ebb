#include "apps/cli/suggest_name.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace pertev {
namespace {

/// Names of ours, each with what other renderers and libraries call the same.
constexpr std::pair<std::string_view, std::string_view> kUsualNames[] = {
    {"size", "width height resolution res image-size image-width image-height w h"},
    {"spp", "samples-per-pixel num-samples n-samples sample-count"},
    {"max-depth", "bounces max-bounces num-bounces n-bounces"},
    {"intrinsics", "k camera-matrix intrinsic-matrix"},
    {"camera-pose", "pose extrinsics c2w cam2world camera-to-world world-from-camera to-world"},
    {"cameras", "poses camera-poses"},
    {"eye", "position origin camera-position"},
    {"target", "look-at lookat"},
    {"fov", "field-of-view fov-y fovy"},
    {"seed", "random-seed rng-seed"},
    {"device", "gpu backend"},
    {"environment", "hdri envmap environment-map skybox"},
    {"aov", "aovs layer layers"},
};

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

bool has_word(std::string_view words, char separator, std::string_view word) {
    return (separator + std::string(words) + separator).find(separator + std::string(word) + separator) !=
           std::string::npos;
}

} // namespace

std::string suggest_name(std::string_view name, std::span<const std::string> names) {
    const std::string wanted = plain(name);
    std::string best;
    if (wanted.empty()) return "";
    for (const auto& [ours, theirs] : kUsualNames) {
        if (!has_word(theirs, ' ', wanted)) continue;
        const auto found = std::ranges::find(names, ours, plain);
        if (found != names.end()) return *found;
    }
    const std::size_t most = std::max<std::size_t>(wanted.size() / 3, wanted.size() > 1 ? 1 : 0);
    std::size_t least = 2 * most + 2;
    for (const std::string& known : names) {
        const std::string candidate = plain(known);
        if (candidate.empty()) continue;
        const bool is_part = wanted.size() > 2 && (candidate.starts_with(wanted) || has_word(candidate, '-', wanted) ||
                                                   wanted.starts_with(candidate + '-'));
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
