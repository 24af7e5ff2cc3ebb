#include "render/light_paths/light_path_layers.h"

#include <algorithm>
#include <unordered_map>

#include <fmt/format.h>

#include "base/error.h"
#include "render/light_paths/light_names.h"

namespace pertev {
namespace {

/// The objects that a kind of filter chooses among.
struct Things {
    std::vector<Names> names;
    const char* kind; // name in messages
};

Things surfaces_of(const Scene& scene) {
    Things things = {{}, "object, mesh, material or node of the scene"};
    for (const Instance& instance : scene.instances) things.names.push_back(names_of(scene, instance));
    if (scene.medium.is_there()) things.names.emplace_back(); // scattering in it has no name
    return things;
}

Things lights_of(const Scene& scene) { return {names_of_lights(scene), "light of the scene"}; }

/// Finds for each object which of all filters accept it. Filters of the other kind accept nothing.
class Chooser {
public:
    Chooser(std::span<const LightPathExpression> expressions, const Things& things, LightPathLetter::Kind kind) {
        for (const LightPathExpression& expression : expressions) {
            std::vector<bool> is_ours(expression.filters.size());
            for (const LightPathLetter& letter : expression.letters) {
                if (letter.kind != kind) continue;
                if (letter.names != kNoNames) is_ours[letter.names] = true;
                for (const ScatteringTerm& term : letter.terms) {
                    if (term.names != kNoNames) is_ours[term.names] = true;
                }
            }
            for (std::size_t i = 0; i < expression.filters.size(); ++i) {
                filters_.push_back(is_ours[i] ? &expression.filters[i] : nullptr);
                if (!is_ours[i]) continue;
                for (const NameFilter::Name& name : expression.filters[i].names) {
                    const auto has = [&](const Names& names) { return has_name(names, name.pattern); };
                    if (std::ranges::any_of(things.names, has)) continue;
                    throw Error(ErrorCode::BadInput, point_at(expression, name.offset,
                                                              fmt::format("there is no {} with this name; {}",
                                                                          things.kind, some_names(things.names))));
                }
            }
        }
    }
    std::vector<bool> choose(const Names& names) const {
        std::vector<bool> chosen(filters_.size());
        for (std::size_t i = 0; i < filters_.size(); ++i) {
            if (filters_[i] == nullptr) continue;
            const auto has = [&](const NameFilter::Name& name) { return has_name(names, name.pattern); };
            chosen[i] = std::ranges::any_of(filters_[i]->names, has) != filters_[i]->is_negated;
        }
        return chosen;
    }

private:
    std::vector<const NameFilter*> filters_; // filters of all expressions; null for the other kind
};

/// Assigns each object the number of its tag.
std::vector<uint16_t> tag(const Things& things, const Chooser& chooser, std::vector<std::vector<bool>>& tags) {
    std::unordered_map<std::vector<bool>, uint16_t> numbers;
    std::vector<uint16_t> of_things;
    for (const Names& names : things.names) {
        const auto [offset, is_new] = numbers.try_emplace(chooser.choose(names), static_cast<uint16_t>(tags.size()));
        if (is_new) tags.push_back(offset->first);
        if (tags.size() > UINT16_MAX) {
            throw Error(ErrorCode::OverLimit, "lpe", "", "the names distinguish more than 65535 objects");
        }
        of_things.push_back(offset->second);
    }
    if (tags.empty()) tags.push_back(chooser.choose({}));
    return of_things;
}

} // namespace

void check_layers(std::span<const LightPathExpression> expressions) {
    std::unordered_map<std::string_view, const LightPathExpression*> named;
    for (const LightPathExpression& expression : expressions) {
        const auto [first, is_new] = named.try_emplace(expression.name, &expression);
        if (is_new) continue;
        throw Error(ErrorCode::BadInput, "lpe", expression.name,
                    fmt::format("two expressions have the same name\n  {0}={1}\n  {0}={2}", expression.name,
                                first->second->text, expression.text));
    }
}

LightPathLayers bind_to_scene(std::vector<LightPathExpression> expressions, const Scene& scene) {
    check_layers(expressions);
    LightPathLayers layers;
    LightPathTags tags;
    const Things surfaces = surfaces_of(scene), lights = lights_of(scene);
    using Kind = LightPathLetter::Kind;
    layers.surface_tags = tag(surfaces, Chooser(expressions, surfaces, Kind::Scattering), tags.surfaces);
    const std::vector<uint16_t> light_tags = tag(lights, Chooser(expressions, lights, Kind::Light), tags.lights);
    layers.automaton = make_automaton(expressions, tags);

    std::vector<uint16_t> numbers;
    for (const uint16_t light_tag : light_tags) numbers.push_back(layers.automaton.lights[light_tag]);
    const auto first_light = numbers.begin() + static_cast<std::ptrdiff_t>(scene.instances.size());
    layers.instance_lights.assign(numbers.begin(), first_light);
    layers.scene_lights.assign(first_light, numbers.end() - 1);
    layers.environment_light = numbers.back();
    layers.expressions = std::move(expressions);
    return layers;
}

} // namespace pertev
