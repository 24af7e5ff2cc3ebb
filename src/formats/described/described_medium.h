#pragma once

// Homogeneous media of pbrt and Mitsuba: their coefficients, those of substances by name, and what they mean for a
// surface.

#include <optional>
#include <string_view>
#include <vector>

#include "base/sink.h"
#include "formats/described/parts.h"
#include "formats/described/surface.h"
#include "scene/medium.h"

namespace pertev::described {

/// Returns the medium with coefficients and anisotropy that are usable: what is negative or not finite is left out with
/// a warning.
MediumParameters usable_medium(MediumParameters medium, const FileLocation& location, Sink& sink);

/// Returns a measured substance, for a unit of millimetres; nothing for another name. Its scattering is the reduced
/// one, so that it is isotropic.
std::optional<MediumParameters> find_substance(std::string_view name);

/// Returns the names of all measured substances.
std::vector<std::string_view> names_of_substances();

/// Returns whether light enters the body of a shape with this surface.
bool is_entered(const Surface& surface);

/// Sets the medium around everything from that of the camera: if it only fills bodies, it is the one outside of them.
/// Leaves out media that are only outside of shapes, and interfaces without a medium on either side.
void finish_media(std::optional<uint32_t> at_camera, Sink& sink, Parts& parts);

/// Fills the body of a surface with a medium, or ends one at it if it is an interface that lets light pass.
void fill_surface(const MediumParameters& medium, const FileLocation& location, Sink& sink, Surface& surface);

} // namespace pertev::described
