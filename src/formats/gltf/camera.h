#pragma once

// glTF cameras. Source: glTF 2.0 section 3.10.

#include "base/sink.h"
#include "formats/json/json_value.h"
#include "scene/camera.h"

namespace pertev::gltf {

/// Reads a camera without its position. Clipping planes are ignored, because nothing is clipped. An invalid angle or
/// aspect is left out with a warning.
Camera read_camera(const JsonValue& camera, Sink& sink);

} // namespace pertev::gltf
