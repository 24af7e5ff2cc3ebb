#include "session/set_materials.h"

#include <algorithm>
#include <map>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/limits.h"
#include "base/message_text.h"
#include "formats/files/parse_number.h"
#include "scene/metals.h"
#include "scene/names.h"
#include "session/material_effects.h"
#include "session/material_names.h"

namespace pertev {
namespace {

constexpr std::string_view kOfConductor[] = {"eta", "k"};

/// Names of OpenPBR Surface 1.1.1 for parameters that have another one here.
struct OpenPbrName {
    std::string_view name, own;
    float factor = 1; // the numbers of this name are multiplied by it
};
constexpr std::string_view kOpacity = "geometry_opacity";
constexpr OpenPbrName kOfOpenPbr[] = {{"base_metalness", "metallic"},
                                      {"specular_roughness", "roughness"},
                                      {"specular_ior", "ior"},
                                      {"thin_film_thickness", "thin_film_thickness_nm", 1e3f}, // from micrometres
                                      {"geometry_thin_walled", "thin_walled"},
                                      {kOpacity, "alpha"}};

bool is_one_of(std::span<const std::string_view> names, std::string_view name) {
    return std::ranges::find(names, name) != names.end();
}

std::string_view name_of_kind(const Material& material) {
    std::string_view found;
    visit_choices(material, [&](auto choice, std::string_view name, std::initializer_list<const char*> names) {
        if (name == "kind") found = names.begin()[static_cast<int>(choice)];
    });
    return found;
}

/// A parameter that a change set.
struct SetKey {
    std::size_t material = 0;
    std::string key, given; // its name here and in the change
};

class Changer {
public:
    Changer(const MaterialChange& change, Material& material, double lumens_per_watt)
        : change_(change), material_(material), lumens_per_watt_(lumens_per_watt) {}

    /// Sets a parameter, and returns its name here.
    std::string set(const std::string& key, const std::string& value) {
        if (key == "base_weight") return set_later(base_weight_, "base_color", key, value, 1, 1);
        if (key == "emission_luminance") return set_later(luminance_, "emission", key, value, 1, kMaxSampleValue);
        if (key == "emission_color") return set_later(emission_color_, "emission", key, value, 3, kMaxSampleValue);
        const auto* const other = std::ranges::find(kOfOpenPbr, key, &OpenPbrName::name);
        const std::string own(other == std::end(kOfOpenPbr) ? key : other->own);
        set_own(own, key, value, other == std::end(kOfOpenPbr) ? 1 : other->factor);
        const bool shows_opacity = material_.alpha_mode != AlphaMode::Opaque || material_.alpha == 1;
        if (key == kOpacity && !shows_opacity) material_.alpha_mode = AlphaMode::Blend;
        return own;
    }

    /// Ends the change, after all its keys.
    void finish(Sink& sink) {
        if (!base_weight_.empty()) material_.base_color = base_weight_[0] * material_.base_color;
        set_emission();
        if (material_.is_clear_boundary) material_.make_clear_boundary();
        if (material_.medium.is_there() && !material_.encloses() && sets_medium())
            sink.leave_out({"material", change_.text, "its medium is left out, because no light enters the material"});
    }

private:
    /// Reads numbers of OpenPBR that finish() uses together with others; returns the name of what they set.
    std::string set_later(std::vector<float>& numbers, const char* sets, const std::string& given,
                          const std::string& text, std::size_t count, float most) {
        numbers = read_numbers(given, text, count, 0, most, 1);
        return sets;
    }

    void set_emission() {
        if (luminance_.empty() && emission_color_.empty()) return;
        if (luminance_.empty()) refuse("emission_color needs emission_luminance");
        const Rgb color =
            emission_color_.empty() ? grey(1) : Rgb{emission_color_[0], emission_color_[1], emission_color_[2]};
        const Rgb emission = static_cast<float>(static_cast<double>(luminance_[0]) / lumens_per_watt_) * color;
        if (max_component(emission) > kMaxSampleValue) refuse("the emission is too large");
        material_.emission = emission;
    }

    /// `given` is the name of `key` in the change.
    void set_own(const std::string& key, const std::string& given, const std::string& value, float factor) {
        if (is_one_of(kOfConductor, key) && material_.kind != MaterialKind::Conductor) {
            refuse(key + " is of kind=conductor alone");
        }
        if (key == "metal") return set_metal(value);
        bool is_known = false;
        visit_choices(material_, [&](auto& choice, std::string_view name, std::initializer_list<const char*> names) {
            if (key != name) return;
            is_known = true;
            const auto found = std::ranges::find(names, value);
            if (found == names.end()) refuse(fmt::format("{} is one of {}", key, fmt::join(names, ", ")));
            choice = static_cast<std::remove_reference_t<decltype(choice)>>(found - names.begin());
        });
        visit_flags(material_, [&](bool& flag, const char* name) {
            if (key != name) return;
            is_known = true;
            if (value != "true" && value != "false") refuse(fmt::format("{} is true or false", given));
            flag = value == "true";
            if (key == "is_clear_boundary" && !flag) refuse(fmt::format("{} can only be true", key));
        });
        set_numbers(key, given, value, factor, is_known);
        if (!is_known) refuse(fmt::format("there is no {}; there are {}", key, fmt::join(known_names(), ", ")));
        if (material_.kind == MaterialKind::Diffuse && makes_reflective(key, has_default(material_, key))) {
            material_.kind = MaterialKind::MetallicRoughness;
        }
    }

    bool sets_medium() const {
        return std::ranges::any_of(change_.values, [](const auto& of) { return of.first.starts_with("medium_"); });
    }

    [[noreturn]] void refuse(const std::string& why) const {
        throw Error(ErrorCode::BadInput, "material", change_.text, why);
    }

    /// Makes the material a conductor with a measured metal's index.
    void set_metal(const std::string& value) {
        const MeasuredMetal* const metal = find_metal(value);
        if (metal == nullptr) refuse("metal is one of " + names_of_metals());
        material_.kind = MaterialKind::Conductor;
        material_.eta = metal->eta;
        material_.k = metal->k;
    }

    void set_numbers(const std::string& key, const std::string& given, const std::string& text, float factor,
                     bool& is_known) {
        std::vector<float*> channels;
        float least = 0, most = 0;
        visit_parameters(
            material_,
            [&](float& value, const char* name, float low, float high) {
                if (key != name) return;
                channels.push_back(&value);
                least = low, most = high;
            },
            [&](TextureRef& ref, const char* name) {
                if (key != name) return;
                is_known = true;
                if (text != "none") refuse(key + " can only be none");
                ref = {};
            });
        if (channels.empty()) return;
        is_known = true;
        const std::vector<float> values = read_numbers(given, text, channels.size(), least, most, factor);
        for (std::size_t i = 0; i < values.size(); ++i) *channels[i] = values[i];
    }

    /// Returns `count` numbers, each times `factor` and from `least` to `most`; one is for all.
    std::vector<float> read_numbers(const std::string& given, const std::string& text, std::size_t count, float least,
                                    float most, float factor) const {
        std::vector<float> values;
        for (std::string_view rest = text;;) {
            const std::size_t comma = std::min(rest.find(','), rest.size());
            std::optional<float> value = parse_whole_float(rest.substr(0, comma));
            if (value) *value *= factor;
            if (!value || !(*value >= least && *value <= most)) {
                refuse(fmt::format("{} is {} from {} to {}", given, count > 1 ? "R,G,B, each" : "a number",
                                   least / factor, most / factor));
            }
            values.push_back(*value);
            if (comma == rest.size()) break;
            rest.remove_prefix(comma + 1);
        }
        if (values.size() == 1) values.resize(count, values[0]);
        if (values.size() != count) refuse(fmt::format("{} has {} numbers", given, count));
        return values;
    }

    static std::vector<std::string> known_names() {
        std::vector<std::string> names = {"metal"};
        MaterialParameters any;
        const auto add = [&](const char* name) {
            if (names.back() != name) names.emplace_back(name);
        };
        visit_choices(any, [&](auto&, const char* name, auto&&) { add(name); });
        visit_flags(any, [&](bool&, const char* name) { add(name); });
        visit_parameters(
            any, [&](float&, const char* name, float, float) { add(name); },
            [&](TextureRef&, const char* name) { add(name); });
        return names;
    }

    const MaterialChange& change_;
    Material& material_;
    double lumens_per_watt_;
    std::vector<float> base_weight_, luminance_, emission_color_; // none: not given
};

/// Warns of parameters that have no effect on the kind of their material, once for each kind.
void report_unused(const Scene& scene, const MaterialChange& change, const std::vector<SetKey>& keys, Sink& sink) {
    struct Unused {
        std::vector<std::size_t> materials;
        std::vector<std::string> keys;
    };
    std::map<std::string_view, Unused> by_kind;
    const auto add = [](auto& list, const auto& value) {
        if (std::ranges::find(list, value) == list.end()) list.push_back(value);
    };
    for (const SetKey& set : keys) {
        const Material& material = scene.materials[set.material];
        if (is_heeded(material, set.key)) continue;
        Unused& unused = by_kind[name_of_kind(material)];
        if (unused.materials.empty() || unused.materials.back() != set.material)
            unused.materials.push_back(set.material);
        add(unused.keys, set.given);
    }
    for (const auto& [kind, unused] : by_kind) {
        sink.warn(
            {"material", change.text,
             fmt::format("{} {} no effect on kind={}, that of {}", fmt::join(unused.keys, ", "),
                         unused.keys.size() == 1 ? "has" : "have", kind, names_of_materials(scene, unused.materials))});
    }
}

/// Returns the key and the value of a last word KEY=VALUE of `text`, and removes them; nothing if there is none.
std::optional<std::pair<std::string, std::string>> take_last_value(std::string_view& text) {
    while (text.ends_with(' ')) text.remove_suffix(1);
    const std::size_t space = text.rfind(' ');
    if (space == text.npos) return std::nullopt;
    const std::string_view word = text.substr(space + 1);
    const std::size_t equals = word.find('=');
    if (equals == word.npos || equals == 0) return std::nullopt;
    text = text.substr(0, space);
    return std::pair(std::string(word.substr(0, equals)), std::string(word.substr(equals + 1)));
}

} // namespace

MaterialChange parse_material_change(std::string_view text) {
    MaterialChange change;
    change.text = text;
    while (auto value = take_last_value(text)) change.values.insert(change.values.begin(), *std::move(value));
    while (text.ends_with(' ')) text.remove_suffix(1);
    change.name = text;
    if (change.name.empty() || change.values.empty()) {
        throw Error(ErrorCode::BadInput, "material", change.text,
                    "expected \"NAME KEY=VALUE\", as in \"gold roughness=0.2\"");
    }
    return change;
}

void set_materials(Scene& scene, std::span<const MaterialChange> changes, Sink& sink, double lumens_per_watt) {
    // A list for each change; they are judged last, because a later change may set the kind.
    std::vector<std::vector<SetKey>> keys;
    for (const MaterialChange& change : changes) {
        keys.emplace_back();
        bool is_found = false;
        std::vector<std::string> names;
        for (std::size_t i = 0; i < scene.materials.size(); ++i) {
            names.push_back(name_of_material(scene, i));
            if (!matches_name(change.name, names.back())) continue;
            is_found = true;
            Changer changer(change, scene.materials[i], lumens_per_watt);
            for (const auto& [key, value] : change.values) keys.back().push_back({i, changer.set(key, value), key});
            changer.finish(sink);
        }
        if (is_found) continue;
        std::vector<Names> all;
        for (const std::string& name : names) all.push_back({name});
        throw Error(ErrorCode::BadInput, "material", change.text,
                    "the scene has no material with this name; " + some_names(all));
    }
    for (std::size_t i = 0; i < changes.size(); ++i) report_unused(scene, changes[i], keys[i], sink);
}

std::string describe_material(const Scene& scene, std::size_t index) {
    const Material& material = scene.materials[index];
    const MaterialParameters usual;
    std::vector<int> usual_choices;
    visit_choices(usual, [&](auto choice, auto&&...) { usual_choices.push_back(static_cast<int>(choice)); });
    std::string text = name_of_material(scene, index);
    std::size_t at = 0;
    visit_choices(material, [&](auto choice, std::string_view name, std::initializer_list<const char*> names) {
        if (static_cast<int>(choice) == usual_choices[at++] && name != "kind") return;
        text += fmt::format(" {}={}", name, names.begin()[static_cast<int>(choice)]);
    });
    std::vector<bool> usual_flags;
    visit_flags(usual, [&](bool flag, const char*) { usual_flags.push_back(flag); });
    at = 0;
    visit_flags(material, [&](bool flag, const char* name) {
        if (flag != usual_flags[at++]) text += fmt::format(" {}={}", name, flag);
    });
    std::vector<float> defaults;
    visit_parameters(
        usual, [&](float value, const char*, float, float) { defaults.push_back(value); }, [](auto&&...) {});
    // Channels of a colour are adjacent and have one name.
    std::string name;
    std::vector<float> values;
    bool differs = false;
    const auto end = [&] {
        const bool is_equal = std::ranges::all_of(values, [&](float value) { return value == values.front(); });
        if (differs || name == "base_color") {
            text += is_equal ? fmt::format(" {}={}", name, values.front())
                             : fmt::format(" {}={}", name, fmt::join(values, ","));
        }
        values.clear();
        differs = false;
    };
    at = 0;
    visit_parameters(
        material,
        [&](float value, const char* of, float, float) {
            if (name != of && !values.empty()) end();
            name = of;
            values.push_back(value);
            differs |= value != defaults[at++];
        },
        [&](const TextureRef& ref, const char* of) {
            if (!values.empty()) end();
            if (!ref.has_image()) return;
            const TextureImage& image = scene.images[static_cast<std::size_t>(ref.image)];
            text +=
                fmt::format(" {}={}", of, image.name.empty() ? fmt::format("{}", ref.image) : shortened(image.name));
        });
    return text;
}

} // namespace pertev
