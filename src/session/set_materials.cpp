#include "session/set_materials.h"

#include <algorithm>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/message_text.h"
#include "formats/files/parse_number.h"
#include "scene/metals.h"
#include "scene/names.h"

namespace pertev {
namespace {

/// Parameters that a Diffuse material does not use.
constexpr std::string_view kOfReflection[] = {
    "metallic", "roughness", "ior", "specular_weight", "specular_color", "transmission_weight", "metal_fresnel"};
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

/// Calls flag(value, name) for each parameter that is true or false.
template <class Parameters, class Flag>
void visit_flags(Parameters& m, const Flag& flag) {
    flag(m.double_sided, "double_sided");
    flag(m.two_sided_emission, "two_sided_emission");
    flag(m.thin_walled, "thin_walled");
    flag(m.is_clear_boundary, "is_clear_boundary");
    flag(m.has_relative_ior, "has_relative_ior");
}

std::string name_of_material(const Scene& scene, std::size_t index) {
    const std::string& name = scene.materials[index].name;
    return name.empty() ? fmt::format("{}", index) : name;
}

class Changer {
public:
    Changer(const MaterialChange& change, Material& material) : change_(change), material_(material) {}

    void set(const std::string& key, const std::string& value) {
        const auto* const other = std::ranges::find(kOfOpenPbr, key, &OpenPbrName::name);
        if (other == std::end(kOfOpenPbr)) return set_own(key, key, value, 1);
        set_own(std::string(other->own), key, value, other->factor);
        const bool shows_opacity = material_.alpha_mode != AlphaMode::Opaque || material_.alpha == 1;
        if (key == kOpacity && !shows_opacity) material_.alpha_mode = AlphaMode::Blend;
    }

    /// Ends the change, after all its keys.
    void finish(Sink& sink) {
        if (material_.is_clear_boundary) material_.make_clear_boundary();
        if (material_.medium.is_there() && !material_.encloses() && sets_medium())
            sink.leave_out({"material", change_.text, "its medium is left out, because no light enters the material"});
    }

private:
    /// `given` is the name of `key` in the change.
    void set_own(const std::string& key, const std::string& given, const std::string& value, float factor) {
        if (is_one_of(kOfReflection, key) && material_.kind == MaterialKind::Diffuse) {
            material_.kind = MaterialKind::MetallicRoughness;
        }
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
        std::vector<float> values;
        for (std::string_view rest = text;;) {
            const std::size_t comma = std::min(rest.find(','), rest.size());
            std::optional<float> value = parse_whole_float(rest.substr(0, comma));
            if (value) *value *= factor;
            if (!value || !(*value >= least && *value <= most)) {
                refuse(fmt::format("{} is {} from {} to {}", given, channels.size() > 1 ? "R,G,B, each" : "a number",
                                   least / factor, most / factor));
            }
            values.push_back(*value);
            if (comma == rest.size()) break;
            rest.remove_prefix(comma + 1);
        }
        if (values.size() == 1) values.resize(channels.size(), values[0]);
        if (values.size() != channels.size()) refuse(fmt::format("{} has {} numbers", given, channels.size()));
        for (std::size_t i = 0; i < values.size(); ++i) *channels[i] = values[i];
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
};

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

void set_materials(Scene& scene, std::span<const MaterialChange> changes, Sink& sink) {
    for (const MaterialChange& change : changes) {
        bool is_found = false;
        std::vector<std::string> names;
        for (std::size_t i = 0; i < scene.materials.size(); ++i) {
            names.push_back(name_of_material(scene, i));
            if (!matches_name(change.name, names.back())) continue;
            is_found = true;
            Changer changer(change, scene.materials[i]);
            for (const auto& [key, value] : change.values) changer.set(key, value);
            changer.finish(sink);
        }
        if (is_found) continue;
        std::vector<Names> all;
        for (const std::string& name : names) all.push_back({name});
        throw Error(ErrorCode::BadInput, "material", change.text,
                    "the scene has no material with this name; " + some_names(all));
    }
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
