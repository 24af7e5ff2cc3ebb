#pragma once

// Point, spot and directional lights. Candela and lux are taken as W/sr and W/m2, one for one.
//
// Source: KHR_lights_punctual.

#include "formats/gltf/json_value.h"
#include "scene/light.h"

namespace pertev::gltf {

/// The light without its place.
Light read_light(const JsonValue& light);

/// Puts `light` at the origin of a node, shining along the node's -z; its strength does not scale. False where that
/// direction is lost.
bool place_light(const Transform& world_from_node, Light& light);

} // namespace pertev::gltf
