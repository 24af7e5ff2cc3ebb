#pragma once

// Gives lights of a scene the intensities of IES photometric files.

#include <span>
#include <string>

#include "base/sink.h"
#include "scene/scene.h"

namespace pertev {

/// Sets each light whose name matches that of a text NAME=FILE to the candelas of the file (formats/ies/read_ies.h),
/// divided by `lumens_per_watt`; it keeps its colour. A spot shines along its axis, a light of a node along the node's
/// -z, any other downwards, with the horizontal angle 0 at +x. Throws Error(BadInput) for a text of another form, a
/// file that cannot be read, a name that no point or spot light has, and a light that two texts name.
void set_profiles(Scene& scene, std::span<const std::string> texts, double lumens_per_watt, Sink& sink);

/// Returns the file of a text NAME=FILE. Throws Error(BadInput) for another form.
std::string file_of_profile(const std::string& text);

} // namespace pertev
