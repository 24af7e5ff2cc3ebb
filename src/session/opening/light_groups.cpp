#include "session/opening/light_groups.h"

#include <algorithm>
#include <vector>

#include <fmt/format.h>

#include "base/error.h"
#include "formats/files/closest_name.h"
#include "render/light_paths/light_names.h"

namespace pertev {
namespace {

[[noreturn]] void refuse(const std::string& text, std::string why) {
    throw Error(ErrorCode::BadInput, "light_group", text, std::move(why));
}

/// Splits a list at its commas, except for those after a backslash.
std::vector<std::string> lights_of(std::string_view list) {
    std::vector<std::string> lights(1);
    for (std::size_t i = 0; i < list.size(); ++i) {
        if (list[i] == ',') {
            lights.emplace_back();
            continue;
        }
        lights.back() += list[i];
        if (list[i] == '\\' && i + 1 < list.size()) lights.back() += list[++i];
    }
    return lights;
}

/// The name as a light-path expression has it between quotes.
std::string quoted(const std::string& name) {
    std::string text = "'";
    for (std::size_t i = 0; i < name.size(); ++i) {
        if (name[i] == '\'') text += '\\';
        text += name[i];
        if (name[i] == '\\' && i + 1 < name.size()) text += name[++i];
    }
    return text + "'";
}

} // namespace

LightPathExpression parse_light_group(const std::string& text) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0 || equals + 1 == text.size())
        refuse(text, "expected NAME=LIGHT,..., such as key=window,lamp*, or NAME=^LIGHT,... for all other lights");
    const bool is_negated = text[equals + 1] == '^';
    std::string names;
    for (const std::string& light : lights_of(std::string_view(text).substr(equals + (is_negated ? 2 : 1)))) {
        if (light.empty() || light == "\\") refuse(text, "a light's name is empty");
        names += (names.empty() ? "" : " ") + quoted(light);
    }
    try {
        return parse_light_path(fmt::format("{}=L<{}{}>.*E", text.substr(0, equals), is_negated ? "^" : "", names));
    } catch (const Error&) { // its text shows an expression that the user did not write
        refuse(text, "expected a layer's name of at most 64 letters, digits, - and _, and names of lights");
    }
}

void check_light_groups(std::span<const std::string> groups, const Scene& scene) {
    const std::vector<Names> lights = names_of_lights(scene);
    std::vector<std::string_view> known;
    for (const Names& names : lights) known.insert(known.end(), names.begin(), names.end());
    for (const std::string& group : groups) {
        const LightPathExpression expression = parse_light_group(group);
        for (const NameFilter::Name& name : expression.filters.front().names) {
            const auto has = [&](const Names& names) { return has_name(names, name.pattern); };
            if (std::ranges::any_of(lights, has)) continue;
            refuse(group, fmt::format("there is no light called '{}'{}; {}", name.pattern,
                                      did_you_mean(name.pattern, known), some_names(lights)));
        }
    }
}

} // namespace pertev
