#include "scene/names.h"

#include <algorithm>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace pertev {
namespace {

/// Appends the names of a node and its ancestors.
void add_node_names(const Scene& scene, uint32_t node, Names& names) {
    for (std::size_t steps = 0; node != kNoNode && steps <= scene.nodes.size(); ++steps) {
        names.push_back(scene.nodes[node].name);
        node = scene.nodes[node].parent;
    }
}

} // namespace

Names names_of(const Scene& scene, const Instance& instance) {
    Names names = {instance.name, scene.meshes[instance.mesh].name, scene.materials[instance.material].name};
    add_node_names(scene, instance.node, names);
    return names;
}
Names names_of(const Scene& scene, const Light& light) {
    Names names = {light.name};
    add_node_names(scene, light.node, names);
    return names;
}

bool matches_name(std::string_view pattern, std::string_view name) {
    // If the text after a * does not match, the last * takes one more letter; only the last one, so that the time is
    // the product of the lengths.
    std::size_t p = 0, n = 0, after_star = std::string_view::npos, taken = 0;
    while (n < name.size()) {
        const bool is_escaped = p + 1 < pattern.size() && pattern[p] == '\\';
        if (!is_escaped && p < pattern.size() && pattern[p] == '*') {
            after_star = ++p;
            taken = n;
        } else if (p < pattern.size() && ((!is_escaped && pattern[p] == '?') || pattern[p + is_escaped] == name[n])) {
            p += is_escaped ? 2 : 1;
            ++n;
        } else if (after_star != std::string_view::npos) {
            p = after_star;
            n = ++taken;
        } else {
            return false;
        }
    }
    while (p < pattern.size() && pattern[p] == '*') ++p;
    return p == pattern.size();
}

bool has_name(const Names& names, std::string_view pattern) {
    return std::ranges::any_of(names, [&](std::string_view name) { return matches_name(pattern, name); });
}

std::string some_names(const std::vector<Names>& things) {
    constexpr std::size_t kMaxShown = 8;
    std::set<std::string_view> names;
    for (const Names& of_one : things) names.insert(of_one.begin(), of_one.end());
    names.erase("");
    std::vector<std::string> shown;
    for (const std::string_view name : names) {
        if (shown.size() < kMaxShown) shown.push_back(fmt::format("'{}'", name));
    }
    if (shown.empty()) return "none has a name";
    return fmt::format("the names are {}{}", fmt::join(shown, ", "), names.size() > kMaxShown ? ", ..." : "");
}

} // namespace pertev
