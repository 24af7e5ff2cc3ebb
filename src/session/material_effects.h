#pragma once

// Which parameters of a material have an effect on its kind.

#include <string_view>

#include "scene/material.h"

namespace pertev {

/// Calls flag(value, name) for each parameter that is true or false.
template <class Parameters, class Flag>
void visit_flags(Parameters& m, const Flag& flag) {
    flag(m.double_sided, "double_sided");
    flag(m.two_sided_emission, "two_sided_emission");
    flag(m.thin_walled, "thin_walled");
    flag(m.is_clear_boundary, "is_clear_boundary");
    flag(m.has_relative_ior, "has_relative_ior");
}

/// Returns whether setting the parameter makes a Diffuse material MetallicRoughness, because it says how the material
/// reflects, or what else it does that no Diffuse one can. `has_default`: the parameter has its default, with which
/// some mean nothing.
bool makes_reflective(std::string_view key, bool has_default);

/// Returns whether the parameter has the value that it has in a new material.
bool has_default(const MaterialParameters& material, std::string_view key);

/// Returns whether not all kinds use the parameter, so that is_heeded() judges it.
bool is_judged(std::string_view key);

/// Returns whether the material does what the parameter asks for: its kind uses the parameter, or always is as the
/// value says. Parameters that no kind lacks are not judged.
bool is_heeded(const MaterialParameters& material, std::string_view key);

} // namespace pertev
