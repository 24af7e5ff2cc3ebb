#pragma once

// glTF cameras. Source: glTF 2.0 section 3.10.

#include <optional>

#include "formats/gltf/json_value.h"
#include "scene/camera.h"

namespace pertev::gltf {

/// The camera without its place. Clipping planes are not read: nothing is clipped.
Camera read_camera(const JsonValue& camera);

/// `m` with scale, shear and mirroring taken out: the same origin, view along the same -z, upright in the same plane.
/// Nothing where those directions are lost.
std::optional<Transform> without_scale(const Transform& m);

} // namespace pertev::gltf
