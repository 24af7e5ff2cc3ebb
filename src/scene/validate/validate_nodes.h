#pragma once

// The part of validate() for nodes, skins and animations.

#include <string>

#include "scene/scene.h"

namespace pertev {

/// Throws Error(BadInput) for an index out of range (of instances, cameras and lights into the nodes, too), nodes that
/// go round in a circle, a number that is not finite, a quaternion of length 0, times that do not rise, and values that
/// do not fit their times.
void validate_nodes(const Scene& scene, const std::string& file);

/// Numbers in a value of the channel, whose target is in range.
std::size_t numbers_in_value(const AnimationChannel& channel, const Scene& scene);
/// What is wrong with a channel whose target is in range, for messages; empty where it is right.
std::string fault_of(const AnimationChannel& channel, const Scene& scene);

} // namespace pertev
