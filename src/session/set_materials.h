#pragma once

// Changes parameters of a scene's materials by text, and describes materials in the same syntax. Parameters have their
// names in scene/material.h; those of the table there need nothing here.

#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/sink.h"
#include "scene/scene.h"
#include "session/photometry.h"

namespace pertev {

struct MaterialChange {
    std::string name; // * and ? are wildcards (scene/names.h); a material without a name has its number
    std::vector<std::pair<std::string, std::string>> values; // parameters and their values
    std::string text;                                        // text of the request
};

/// Parses NAME KEY=VALUE, with any number of KEY=VALUE. Throws Error(BadInput), like set_materials().
MaterialChange parse_material_change(std::string_view text);

/// Sets the parameters of every material with one of these names, in order. A value is a number, a colour (R,G,B or one
/// number), true or false, a name for a choice (visit_choices) and for `metal`, which makes a conductor of a measured
/// one (scene/metals.h), or `none` to drop a texture. Textures multiply their parameter as before. A Diffuse material
/// becomes MetallicRoughness if its reflection is set (metallic, roughness, ior, specular, transmission), or what only
/// that kind does (makes_reflective in session/material_effects.h). OpenPBR's names of parameters that have others here
/// are known, too (base_metalness, specular_roughness, specular_ior, thin_film_thickness in micrometres,
/// geometry_thin_walled, geometry_opacity, which blends), and base_weight, which multiplies base_color, and
/// emission_luminance in nits with emission_color. `sink` gets a warning of parameters that have no effect on the kind
/// of their material after all changes. Throws for an unknown name or parameter, and for a value beyond the parameter's
/// range. `lumens_per_watt`: see session/photometry.h.
void set_materials(Scene& scene, std::span<const MaterialChange> changes, Sink& sink = nobody(),
                   double lumens_per_watt = kLumensPerWatt);

/// Describes a material as NAME KEY=VALUE ...: its kind, its colour, and what differs from the defaults. A texture has
/// its image's name.
std::string describe_material(const Scene& scene, std::size_t index);

} // namespace pertev
