#pragma once

// glTF cameras. Source: glTF 2.0 section 3.10.

#include "formats/json/json_value.h"
#include "scene/camera.h"

namespace pertev::gltf {

/// The camera without its place. Clipping planes are not read: nothing is clipped.
Camera read_camera(const JsonValue& camera);

} // namespace pertev::gltf
