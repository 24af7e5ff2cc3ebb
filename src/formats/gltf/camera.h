#pragma once

// glTF cameras. Source: glTF 2.0 section 3.10.

#include "base/messages.h"
#include "formats/json/json_value.h"
#include "scene/camera.h"

namespace pertev::gltf {

/// The camera without its place. Clipping planes are not read: nothing is clipped. An angle or aspect that makes no
/// sense is left out with a warning.
Camera read_camera(const JsonValue& camera, Messages& messages);

} // namespace pertev::gltf
