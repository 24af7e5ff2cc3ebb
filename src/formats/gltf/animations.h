#pragma once

// Animations as key frames. Source: glTF 2.0 section 3.11; KHR_animation_pointer for the properties of nodes that have
// a path of their own, the angle of view of perspective cameras, and colour or intensity of punctual lights.

#include <cstdint>
#include <set>
#include <span>

#include "formats/gltf/accessor.h"
#include "scene/scene.h"

namespace pertev::gltf {

/// Nodes whose morph weights a channel of a clip that plays changes. Looks at no more than that of the animations.
std::set<uint32_t> nodes_with_animated_weights(const Document& document, std::span<const Clip> clips);

/// Fills scene.animations with the clips that play, and says in scene.clips when each clip ends; nodes, cameras, lights
/// and clips are there. Nothing is said of channels of clips that do not play. Throws Error(BadInput) for what is no
/// animation by the format (an index out of range, an accessor of the wrong type or out of its data, an unknown path or
/// interpolation, a node or mesh that cannot be animated so, as many values as the interpolation does not take). A
/// channel with numbers that mean nothing (times that do not rise, a quaternion of 0, a number that is not finite) is
/// left out with a warning, and so is one that points at another property: a still picture does not need it.
void read_animations(const Document& document, Buffers& buffers, Scene& scene, Messages& messages);

} // namespace pertev::gltf
