#pragma once

// Keeps values out of the scene that validate() refuses with the whole file, such as products of a file's numbers that
// are no finite floats.

#include "base/error.h"
#include "base/sink.h"
#include "math/rgb.h"
#include "math/vec3.h"
#include "scene/camera.h"
#include "scene/material.h"

namespace pertev::described {

/// Returns whether each channel is a finite number of at least 0, as that of a light.
bool is_light(Rgb strength);
/// Leaves out a light whose strength is not usable, with a warning. `which` names it, such as "a point".
void leave_out_strength(const std::string& which, const FileLocation& location, Sink& sink);
/// Returns whether a light or a camera may be at a position.
bool is_near(Vec3 position);
/// Returns why a camera is not usable; empty if it is.
std::string fault_of(const Camera& camera);
/// Replaces numbers of a material that are not finite by the nearest in their range, and transforms of textures too
/// large for a float's precision by none, with a warning at `location`.
void keep_usable(Material& material, const FileLocation& location, Sink& sink);

} // namespace pertev::described
