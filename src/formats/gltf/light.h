#pragma once

// Point, spot and directional lights. Candela and lux are read as W/sr and W/m2, one for one.
//
// Source: KHR_lights_punctual.

#include <span>
#include <string_view>

#include "base/sink.h"
#include "formats/json/json_value.h"
#include "scene/light.h"

namespace pertev::gltf {

/// Returns the names of the extensions that lights are read from.
std::span<const std::string_view> light_extensions();
/// Reads a light without its position. A cone with equal angles (which exporters write for a sharp edge) is accepted
/// with a warning. A negative strength becomes 0, and any other unreadable member is left out.
Light read_light(const JsonValue& light, Sink& sink);

/// Places a light at its node. Returns false if a direction that it needs is lost, as by a transform so large that it
/// has no length.
bool place_light(const Transform& world_from_node, Light& light);

} // namespace pertev::gltf
