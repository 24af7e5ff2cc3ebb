#include "session/set_emitters.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "formats/files/parse_number.h"
#include "math/double_pi.h"
#include "scene/names.h"
#include "session/emitter_surface.h"
#include "session/photometry.h"
#include "shading/punctual_light.h"

namespace pertev {
namespace {

constexpr std::pair<std::string_view, EmitterUnit> kUnits[] = {{"nits", EmitterUnit::Nit}, // the longest first
                                                               {"lm", EmitterUnit::Lumen},
                                                               {"cd", EmitterUnit::Candela},
                                                               {"lx", EmitterUnit::Lux},
                                                               {"W", EmitterUnit::Watt}};

[[noreturn]] void refuse(const EmitterStrength& emitter, const std::string& why) {
    throw Error(ErrorCode::BadInput, "lamp", emitter.text, why);
}

double luminance_of(double r, double g, double b) { return 0.2126 * r + 0.7152 * g + 0.0722 * b; }
double luminance_of(Rgb c) {
    return luminance_of(static_cast<double>(c.r), static_cast<double>(c.g), static_cast<double>(c.b));
}

/// Scales `colour` to this luminance.
Rgb with_luminance(const EmitterStrength& emitter, Rgb colour, double luminance) {
    colour = color_of_emitter(colour);
    const double factor = luminance / luminance_of(colour);
    const Rgb result = static_cast<float>(factor) * colour;
    if (!is_finite(result) || max_component(result) > 0x1p40f) refuse(emitter, "the amount of light is too large");
    return result;
}

/// Converts an amount of flux to lumens.
double lumens(const EmitterStrength& emitter) {
    return emitter.value * (emitter.unit == EmitterUnit::Watt ? kLumensPerWatt : 1);
}

/// Returns the luminous flux of a light, in lumens, that has a luminous intensity of 1 cd and its own colour.
double lumens_of_candela(const Light& light) {
    if (!parts_of(light.kind).table) return punctual_power(light, 1, 0);
    const Rgb color = color_of_emitter(light.intensity);
    return static_cast<double>(luminance(light.table->integral * color)) / static_cast<double>(luminance(color));
}

void set_light(const EmitterStrength& emitter, double lumens_per_watt, Light& light) {
    const auto set = [&](double photometric) {
        light.intensity = with_luminance(emitter, light.intensity, photometric / lumens_per_watt);
    };
    const LightParts parts = parts_of(light.kind);
    const bool is_far = !parts.position;
    switch (emitter.unit) {
    case EmitterUnit::Watt:
    case EmitterUnit::Lumen:
        if (is_far) break;
        return set(lumens(emitter) / lumens_of_candela(light));
    case EmitterUnit::Candela:
        if (is_far) break;
        return set(emitter.value);
    case EmitterUnit::Lux:
        if (!is_far) break;
        return set(emitter.value);
    case EmitterUnit::Nit:
        break;
    }
    refuse(emitter,
           fmt::format("{} is a {}, whose unit must be {}", light.name.empty() ? "the light" : "'" + light.name + "'",
                       is_far        ? "directional light"
                       : parts.table ? "goniometric light"
                       : parts.cone  ? "spot light"
                                     : "point light",
                       is_far ? "lx" : "W, lm or cd"));
}

/// Returns a material that only this instance uses, copied if necessary. `users` counts the instances of each
/// material.
Material& own_material(Scene& scene, std::size_t index, std::vector<uint32_t>& users) {
    const uint32_t material = scene.instances[index].material;
    if (users[material] > 1) {
        --users[material];
        users.push_back(1);
        scene.materials.push_back(scene.materials[material]);
        scene.instances[index].material = static_cast<uint32_t>(scene.materials.size() - 1);
    }
    return scene.materials[scene.instances[index].material];
}

void set_surface(const EmitterStrength& emitter, double lumens_per_watt, Scene& scene, std::size_t index,
                 std::vector<uint32_t>& users) {
    const Instance& instance = scene.instances[index];
    const Material& before = scene.materials[instance.material];
    double nits = emitter.value;
    if (emitter.unit == EmitterUnit::Lux)
        refuse(emitter, "an emitter with an area needs W, lm, cd or nits; lx are for directional lights");
    if (emitter.unit != EmitterUnit::Nit) {
        if (instance.is_hidden) return; // it emits nothing, and has no size now
        const EmitterSurface size = emitter_surface(scene, instance);
        if (before.alpha_mode != AlphaMode::Opaque) {
            refuse(emitter, "the emitting area is unknown, because the surface has holes or transmits light; use nits");
        }
        if (!(size.area > 0)) refuse(emitter, "the emitter has no area");
        if (emitter.unit == EmitterUnit::Candela && !size.is_flat) {
            refuse(emitter, "the emitter is not flat, so it has no single intensity; use W, lm or nits");
        }
        const double faces = before.two_sided_emission ? 2 : 1;
        nits = emitter.unit == EmitterUnit::Candela ? emitter.value / size.area
                                                    : lumens(emitter) / (kPiDouble * size.area * faces);
        // This is the mean over the surface, so the factor of a texture is brighter.
        const Rgb unit = with_luminance(emitter, before.emission, 1);
        const double textured =
            luminance_of(static_cast<double>(unit.r) * size.texture[0], static_cast<double>(unit.g) * size.texture[1],
                         static_cast<double>(unit.b) * size.texture[2]);
        if (!(textured > 0)) refuse(emitter, "the emission texture is completely black");
        nits = nits / textured;
    }
    Material& material = own_material(scene, index, users);
    material.emission = with_luminance(emitter, material.emission, nits / lumens_per_watt);
}

void set_environment(const EmitterStrength& emitter, double lumens_per_watt, Environment& environment) {
    if (emitter.unit != EmitterUnit::Nit) refuse(emitter, "an environment needs nits");
    if (!environment.image.pixels.empty()) {
        refuse(emitter, "the environment is a panorama, which has no single luminance; set `environment_scale`");
    }
    environment.scale = with_luminance(emitter, environment.scale, emitter.value / lumens_per_watt);
}

} // namespace

EmitterStrength parse_emitter(std::string_view text) {
    EmitterStrength emitter;
    emitter.text = text;
    const std::size_t equals = text.rfind('=');
    const auto fail = [&] { refuse(emitter, "expected NAME=800lm; units are W, lm, cd, lx and nits"); };
    if (equals == std::string_view::npos || equals == 0) fail();
    emitter.name = text.substr(0, equals);
    std::string_view amount = text.substr(equals + 1);
    const auto unit = std::ranges::find_if(kUnits, [&](const auto& u) { return amount.ends_with(u.first); });
    if (unit == std::end(kUnits)) fail();
    emitter.unit = unit->second;
    amount.remove_suffix(unit->first.size());
    while (amount.ends_with(' ')) amount.remove_suffix(1);
    emitter.value = parse_whole_float<double>(amount).value_or(-1);
    if (!(emitter.value >= 0 && emitter.value <= 1e15)) fail();
    return emitter;
}

void set_emitters(Scene& scene, std::span<const EmitterStrength> emitters, double lumens_per_watt) {
    std::vector<uint32_t> users(scene.materials.size());
    for (const Instance& instance : scene.instances) ++users[instance.material];
    for (const EmitterStrength& emitter : emitters) {
        std::vector<Names> all; // names of everything that emits light
        bool is_found = false;
        const auto is_called_so = [&](const Names& names) {
            all.push_back(names);
            const bool is_one = has_name(names, emitter.name);
            is_found |= is_one;
            return is_one;
        };
        for (std::size_t i = 0; i < scene.instances.size(); ++i) {
            if (!scene.materials[scene.instances[i].material].is_emitter()) continue;
            if (is_called_so(names_of(scene, scene.instances[i])))
                set_surface(emitter, lumens_per_watt, scene, i, users);
        }
        for (Light& light : scene.lights) {
            if (is_called_so(names_of(scene, light))) set_light(emitter, lumens_per_watt, light);
        }
        if (scene.environment && is_called_so({kEnvironmentName})) {
            set_environment(emitter, lumens_per_watt, *scene.environment);
        }
        if (!is_found) refuse(emitter, "the scene has no light with this name; " + some_names(all));
    }
}

} // namespace pertev
