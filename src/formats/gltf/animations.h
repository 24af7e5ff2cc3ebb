#pragma once

// Animations as key frames. Source: glTF 2.0 section 3.11; KHR_animation_pointer for the properties of nodes that
// have a path of their own, their visibility (KHR_node_visibility), the field of view of perspective cameras, colour or
// intensity of punctual lights, and the numbers of materials (material_pointers.h).

#include <cstdint>
#include <set>
#include <span>
#include <string>

#include "formats/gltf/accessor.h"
#include "formats/gltf/materials.h"
#include "scene/scene.h"

namespace pertev::gltf {

/// Nodes whose morph weights are changed by a channel of a playing clip. Reads only that part of the animations.
std::set<uint32_t> nodes_with_animated_weights(const Document& document, std::span<const Clip> clips);
/// Nodes that a channel of a playing clip shows or hides.
std::set<uint32_t> nodes_with_animated_visibility(const Document& document, std::span<const Clip> clips);

/// JSON pointers of KHR_animation_pointer in channels of playing clips.
std::set<std::string> animated_pointers(const Document& document, std::span<const Clip> clips);

/// Fills scene.animations with the clips that play, and the end of each clip in scene.clips; nodes, cameras, lights
/// and clips have been read. Channels of clips that do not play cause no messages. An unreadable channel is left out
/// with a warning, because a still picture does not need it. It may violate the format (an index out of range, an
/// unknown path or interpolation, a node that cannot be animated so), contain meaningless numbers (a quaternion of 0,
/// a number that is not finite), or have the target of an earlier channel of its animation. Keys are repaired
/// (repair_keys).
void read_animations(const Document& document, Buffers& buffers, const Materials& materials, Scene& scene, Sink& sink);

} // namespace pertev::gltf
