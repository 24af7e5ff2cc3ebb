#pragma once

// Point, spot and directional lights. Candela and lux are taken as W/sr and W/m2, one for one.
//
// Source: KHR_lights_punctual.

#include "base/messages.h"
#include "formats/json/json_value.h"
#include "scene/light.h"

namespace pertev::gltf {

/// The light without its place. A cone of equal angles (exporters write it for a sharp edge) is one after a warning.
/// A strength below 0 is 0, and any other member that cannot be read is left out.
Light read_light(const JsonValue& light, Messages& messages);

} // namespace pertev::gltf
