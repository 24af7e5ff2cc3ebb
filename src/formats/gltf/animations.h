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
/// and clips are there. Nothing is said of channels of clips that do not play. A channel that cannot be read is left
/// out with a warning: a still picture does not need it. It may be none by the format (an index out of range, an
/// unknown path or interpolation, a node that cannot be animated so), hold numbers that mean nothing (a quaternion of
/// 0, a number that is not finite), or change what an earlier one of its animation changes. Keys are mended
/// (mend_keys).
void read_animations(const Document& document, Buffers& buffers, Scene& scene, Messages& messages);

} // namespace pertev::gltf
